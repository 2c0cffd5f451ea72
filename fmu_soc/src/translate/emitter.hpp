// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/execution.hpp"
#include "translate/code_memory.hpp"
#include "translate/exit_table.hpp"
#include "translate/region.hpp"
#include "translate/registers.hpp"
#include "translate/translator.hpp"

#include <xbyak/xbyak.h>

#include <array>
#include <bit>
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace Xbyak::util {
class Cpu;
}

namespace mebots::soc::translate {

/// The features of the host's processor. Read when the library is loaded: in a virtual machine each query is slow.
const Xbyak::util::Cpu& host_processor();

/// Offset of a hardware loop from Execution.
constexpr int offset_of_loop(unsigned loop) {
  return static_cast<int>(offsetof(Execution, loops) + sizeof(HardwareLoop) * loop);
}

/// Offset of a guest register from Execution.
constexpr int offset_of_register(unsigned reg) {
  return static_cast<int>(offsetof(Execution, x) + sizeof(std::uint32_t) * reg);
}

/// Writes the host code of one region. Needs a processor with BMI1, BMI2 and LZCNT.
///
///   rbx    Execution
///   r14    bytes of the first fast memory
///   r15    where the count of cycles stands, as of the start of the block and what came up by execution in it: cycles
///          that may still start; where banks are shared, the row of their table, which is one on for each cycle
///   xmm15  counts: instructions and accesses (32 bits each), energy of instructions [fJ]
///   xmm3 to xmm14  guest registers that dot products work on, in the low word; what stands above means nothing
///   rax, rcx, rdx, xmm0 to xmm2  scratch; all others hold guest registers, zero-extended
///
/// A block that is left by a jump forgets what came before it. One that is left straight on may delay the next one:
/// that is added on the edge, and `HostState::came_from` says which it was, for who leaves that next one early.
class Emitter : public Xbyak::CodeGenerator {
 public:
  /// Fixed pieces of code that all regions share.
  struct Gates {
    const std::uint8_t* enter = nullptr;  // to be executed
    const std::uint8_t* leave = nullptr;  // as written; eax = number of the exit
    /// Likewise, for a block that may not begin; rdx = where it does, rcx as load_next_point() leaves it.
    const std::uint8_t* park = nullptr;
    /// As written, to be called: brings line edx of the code, whose presence is noted in byte [rcx], into the set that
    /// begins at byte rax of the entries. Null without an instruction cache, and where others use it.
    const std::uint8_t* fetch = nullptr;
    /// As written, to be called: counts an access at offset ecx of the second memory, and spends what it waits; edx
    /// cycles of the block come before. eax below 0: nothing done, the interpreter must make it. rdx is lost. Null
    /// where nobody else uses that memory.
    const std::uint8_t* far = nullptr;
  };
  /// In place of the number of an exit: not in translated code.
  static constexpr std::uint64_t kNoExit = 0xffffffff;

  /// Writes behind the first `used` bytes.
  Emitter(const CodeMemory& code_memory, std::size_t used, const BlockCache& blocks, const Execution& execution,
          const Options& options, ExitTable& exits);

  /// The gates, at the start of the code memory.
  Gates emit_gates();
  /// A region, which can be entered at each of its nodes.
  std::vector<Entry> emit(const Region& region, const Registers& registers, const Gates& gates);
  std::size_t size() const { return getSize(); }

  using Reg32 = Xbyak::Reg32;
  using Label = Xbyak::Label;

  // gates.cpp
  void emit_account();
  void emit_next_core(const Label& next_core, const Label& done);
  void emit_fetch_gate();
  void emit_far_gate();

  // emitter.cpp: blocks, operands
  void emit_node(const Node& node);
  bool emit_instruction(const Instruction* at);
  Entry emit_entry(const Node& node, bool runs_into_node);
  void load_registers();
  void store_registers();
  bool in_host(unsigned reg) const { return registers_->host[reg] != Registers::kInMemory; }
  bool in_vector(unsigned reg) const { return registers_->vector[reg] != Registers::kInMemory; }
  Xbyak::Xmm vector(unsigned reg) const;
  Reg32 host(unsigned reg) const;
  Xbyak::Address memory(unsigned reg) { return dword[rbx + offset_of_register(reg)]; }
  /// A register as an operand of the host's instruction; neither x0 nor one in a vector register.
  const Xbyak::Operand& operand(unsigned reg);
  /// Likewise to be read only, from `scratch` where it lives in a vector register.
  const Xbyak::Operand& source(unsigned reg, const Reg32& scratch);
  /// A register's value in a host register, which must not be changed unless it is `scratch`.
  Reg32 value(unsigned reg, const Reg32& scratch);
  /// Where to compute a result: the register's own place, or `scratch` when it has none or is needed until the end.
  Reg32 place(unsigned rd, const Reg32& scratch, bool needed_later = false) const;
  void finish(unsigned rd, const Reg32& result);
  /// ecx may be lost.
  void set(unsigned rd, std::uint32_t constant);
  /// Flags stay.
  void copy(const Reg32& to, unsigned reg);

  /// A register's value in a vector register, which must not be changed unless it is `scratch`.
  Xbyak::Xmm in_vector_for(unsigned reg, const Xbyak::Xmm& scratch);
  /// A result in the low word of a vector register.
  void finish_vector(unsigned rd, const Xbyak::Xmm& result);

  // loops.cpp
  void emit_iteration(const Instruction* at, unsigned loop);
  const Node* straight_successor(const Instruction* at, std::uint32_t link) const;
  void emit_straight_edge(const Instruction* at, std::uint32_t link, std::uint32_t pc, bool is_last);
  void emit_straight_to(const Instruction* at, const Node& node, bool is_last);
  void note_what_came(const Instruction* end);
  void forget_what_came();

  // memory.cpp
  bool near(const void* table, std::size_t size) const;
  int from_first_memory(const void* table) const;
  Xbyak::Address marks_of_word(unsigned words);
  void emit_claim(const Instruction* at, bool word_in_ecx);

  // exits.cpp
  /// `jump(label)` jumps if the branch is taken.
  template <typename Jump>
  void emit_taken_edge(const Instruction* at, Jump jump) {
    Label taken;
    jump(taken);
    aside([this, at, taken]() mutable {
      L(taken);
      emit_edge(at, static_cast<std::uint32_t>(at->imm), true);
    });
  }
  /// Behind a jump to the address in eax.
  void emit_indirect_edge(const Instruction* at);
  void emit_edge(const Instruction* at, std::uint32_t pc, bool jumped);
  bool is_noted(const Instruction* at, std::uint32_t next) const;
  template <typename SetNext>
  void note_flow(const Instruction* at, SetNext set_next);
  void note_flow_to(const Instruction* at, std::uint32_t next);
  void note_flow_to(const Instruction* at, const Reg32& next);
  void note_flow_inside(const Instruction* at);
  void count(const Instruction* at, std::uint32_t extra_cycles);
  void take_back(const Instruction* at);
  void spend(std::uint32_t cycles);
  /// The register is lost.
  void spend(const Xbyak::Reg64& cycles);
  static std::uint64_t bits_of(const Pipeline& pipeline) { return std::bit_cast<std::uint64_t>(pipeline); }
  void check_limit(const Node& node, std::uint32_t stall, const Exit& at_limit);
  void check_limit(const Node& node);
  void jump_at_limit(const Block& block, std::uint32_t stall, Label& leave);
  bool fetches_inline() const { return !options_.loose_limit; }
  void compare_presence(std::uint32_t address);
  void jump_when_absent(std::uint32_t address, Label& absent);
  void emit_fetch(const Block& block, const Instruction* at, const Instruction* before);
  void emit_fetch_line(std::uint32_t line, std::uint32_t address, bool often_absent);
  void emit_refill(std::uint32_t line, std::uint32_t address);
  const Node* node_at(std::uint32_t link, std::uint32_t pc) const;
  void emit_leave(const Exit& exit);
  void emit_park(const Node& node, const Exit& exit, std::uint32_t stall);
  void emit_park_at_entry(const Node& node, const Exit& exit, std::uint32_t stall);
  void note_place(const Node& node);
  void load_next_point();
  void emit_chained_exit(Exit exit);
  void emit_resume(const Instruction* at);
  std::uint32_t waits_before(const Instruction* at) const { return ram_[0].wait_cycles * at->accesses_before; }
  std::uint32_t add_exit(const Exit& exit);
  std::size_t index_of(const Node& node) const { return static_cast<std::size_t>(&node - region_->nodes.data()); }
  Label& label_of(const Node& node) { return labels_[index_of(node)]; }
  /// To be emitted behind the region's hot code: what runs as well, but not each time.
  void aside(std::function<void()> emit) { warm_.push_back(std::move(emit)); }
  /// To be emitted behind all that: what hardly ever runs, so that no line of the host's caches holds both.
  void later(std::function<void()> emit) { cold_.push_back(std::move(emit)); }
  void emit_warm_and_cold();

  /// The host's number of the first of kVectorRegisters.
  static constexpr int kFirstVector = 3;

  const FastRegion ram_[2];
  const CodeMemory& code_memory_;
  const BlockCache& blocks_;
  const Options options_;
  ExitTable& exits_;
  const Region* region_ = nullptr;
  const Registers* registers_ = nullptr;
  Gates gates_;
  std::vector<Label> labels_;
  const Node* following_ = nullptr;     // emitted after it
  std::vector<Label> entries_;          // plain ones
  std::vector<Label> stalled_entries_;  // of those that ask for a stall
  Label leave_all_;                     // stores the registers and leaves by exit eax
  Label park_all_;                      // likewise, to go on at rdx; rcx as in `Gates::park`
  std::deque<std::function<void()>> warm_;
  std::deque<std::function<void()>> cold_;
  std::map<std::pair<std::uint64_t, std::uint64_t>, Label> constants_;
  std::vector<Xbyak::Address> memory_operands_;  // by guest register
};

}  // namespace mebots::soc::translate
