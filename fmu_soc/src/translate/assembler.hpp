// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/execution.hpp"
#include "mebots/assert.hpp"
#include "translate/code_memory.hpp"
#include "translate/cycle_accounting.hpp"
#include "translate/edge_writer.hpp"
#include "translate/exit_table.hpp"
#include "translate/fetch_writer.hpp"
#include "translate/registers.hpp"
#include "translate/translator.hpp"

#include <xbyak/xbyak.h>

#include <array>
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <utility>
#include <vector>

namespace Xbyak::util {
class Cpu;
}

namespace mebots::soc::translate {

using Xbyak::Label;
using Xbyak::Reg32;

/// The features of the host's processor. Read when the library is loaded: in a virtual machine each query is slow.
const Xbyak::util::Cpu& host_processor();

/// A jump with a distance of 32 bits.
inline constexpr auto kNear = Xbyak::CodeGenerator::T_NEAR;

/// Offset from Execution of a member of its HostState, or of its counters.
constexpr int offset_of_host(std::size_t member) {
  return static_cast<int>(offsetof(Execution, host) + member);
}
constexpr int offset_of_counter(std::size_t member) {
  return static_cast<int>(offsetof(Execution, counters) + member);
}

/// Offset of a hardware loop from Execution.
constexpr int offset_of_loop(unsigned loop) {
  return static_cast<int>(offsetof(Execution, loops) + sizeof(HardwareLoop) * loop);
}

/// Pieces of code that all regions share.
struct Stubs {
  const std::uint8_t* prologue = nullptr;  // to be executed
  const std::uint8_t* leave = nullptr;     // as written; eax = number of the exit
  /// As written, for a block that may not begin; rdx = where it does, rcx as load_next_point() leaves it.
  const std::uint8_t* park = nullptr;
  /// As written, to be called: brings line edx of the code, whose presence is noted in byte [rcx], into the set that
  /// begins at byte rax of the entries. Null without an instruction cache, and where others use it.
  const std::uint8_t* fetch = nullptr;
  /// As written, to be called: counts an access at offset ecx of the second memory, and spends what it waits; edx
  /// cycles of the block come before. eax below 0: nothing done, the interpreter must make it. rdx is lost. Null
  /// if no other core uses that memory.
  const std::uint8_t* far = nullptr;
};

/// In place of the number of an exit: not in translated code.
inline constexpr std::uint64_t kNoExit = 0xffffffff;

/// What the code of all regions of a translator depends on.
struct TranslationContext {
  const CodeMemory& code_memory;
  const BlockCache& blocks;
  const FastRegion (&ram)[2];
  const Options& options;
  ExitTable& exits;
};

/// The assembler that lowerings write to: host code, where guest registers are, counts, edges. Needs a processor with
/// BMI1, BMI2 and LZCNT.
///
///   rbx    Execution
///   r14    bytes of the first fast memory
///   r15    count of cycles at the start of the block, with those that only execution tells: cycles that may still
///          start; if banks are shared, the row of their table, which is the next one for each cycle
///   xmm15  counts: instructions and accesses (32 bits each), energy of instructions [fJ]
///   xmm3 to xmm14  guest registers that dot products work on, in the low word; the bits above have no meaning
///   rax, rcx, rdx, xmm0 to xmm2  scratch; the other registers hold guest registers, zero-extended
class Assembler : public Xbyak::CodeGenerator {
 public:
  /// Writes behind the first `used` bytes of the code memory.
  Assembler(const TranslationContext& context, std::size_t used, const Stubs& stubs);

  /// Defers a warm path: code that runs as well, but not each time, behind the region's hot code.
  void defer_warm(std::function<void()> emit) { warm_.push_back(std::move(emit)); }
  /// Defers a cold path: code that hardly ever runs, behind all that, so that no line of the host's caches holds both.
  void defer_cold(std::function<void()> emit) { cold_.push_back(std::move(emit)); }
  void emit_deferred();

  /// A constant of 16 bytes, and the place where all are written.
  const Label& constant(std::uint64_t low, std::uint64_t high) { return constants_[{low, high}]; }
  void emit_constants();

  /// True if a table is within reach of r14.
  bool is_near(const void* table, std::size_t size) const;
  int from_first_memory(const void* table) const;
  /// The marks of one or two words of the first memory from that with number ecx; rdx may be lost.
  Xbyak::Address marks_of_word(unsigned words);

  const CodeMemory& code_memory;
  const BlockCache& blocks;
  const FastRegion (&ram)[2];
  const Options& options;
  ExitTable& exits;
  const Stubs stubs;
  RegisterMap registers{*this};
  CycleAccounting cycles{*this};
  FetchWriter fetches{*this};
  EdgeWriter edges{*this};

 private:
  std::deque<std::function<void()>> warm_;
  std::deque<std::function<void()>> cold_;
  std::map<std::pair<std::uint64_t, std::uint64_t>, Label> constants_;
};

template <typename Jump>
void EdgeWriter::branch(const Instruction* at, Jump jump_to) {
  MEBOTS_ASSERT(is_branch(at->op));
  Label taken;
  jump_to(taken);
  a_.defer_warm([this, at, taken]() mutable {
    a_.L(taken);
    jump(at, static_cast<std::uint32_t>(at->imm), true);
  });
}

/// Writes the stubs, at the start of the code memory.
Stubs emit_stubs(Assembler& a);
/// Writes the code of a region, which can be entered at each of its nodes.
std::vector<Entry> emit_region(Assembler& a, const Region& region);

}  // namespace mebots::soc::translate
