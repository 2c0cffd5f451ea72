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
#include "translate/xbyak.hpp"

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

/// Returns the features of the host's processor. They are read when the library is loaded, because a query is slow in a
/// virtual machine.
const Xbyak::util::Cpu& host_processor();

/// Makes Xbyak encode a jump with a 32-bit distance.
inline constexpr auto kNear = Xbyak::CodeGenerator::T_NEAR;

/// These functions return the offset of a member from the start of Execution. `member` is its offset in HostState or
/// Counters.
constexpr int offset_of_host(std::size_t member) {
  return static_cast<int>(offsetof(Execution, host) + member);
}
constexpr int offset_of_counter(std::size_t member) {
  return static_cast<int>(offsetof(Execution, counters) + member);
}

/// Returns the offset of a hardware loop's registers from the start of Execution.
constexpr int offset_of_loop(unsigned loop) {
  return static_cast<int>(offsetof(Execution, loops) + sizeof(HardwareLoop) * loop);
}

/// Addresses of the code that all regions share.
struct Stubs {
  const std::uint8_t* prologue = nullptr;  // executable address
  const std::uint8_t* leave = nullptr;     // writable address; expects the number of the exit in eax
  /// Calls Options::perform for the exit whose number is in eax. Writable address. Null if Options::perform is null.
  const std::uint8_t* perform = nullptr;
  /// Leaves translated code before a block that may not begin. If the core has reached its limit, stores a resume point
  /// and continues with the hart in HostState::next. Writable address. Expects the address of the block's entry in rdx,
  /// and the value that load_next_point() loaded in rcx.
  const std::uint8_t* park = nullptr;
  // Subroutines that refill the instruction cache (writable addresses). They expect the number of a line in ecx: see
  // InstructionCache::number_of(). They are null if there is no instruction cache, or if other cores use it.
  /// Fetches the line. Expects InstructionCache::first_entry() of the line in rdx. Changes rax and rdx.
  const std::uint8_t* fetch = nullptr;
  /// Fetches lines from ecx on: line ecx + i if bit i of eax is set and the line is absent. Expects
  /// InstructionCache::first_entry() of line ecx in rdx. Changes rax.
  const std::uint8_t* fetch_group = nullptr;
  /// Undoes refills of lines from ecx on: of line ecx + i if bit i of edx is set, and if fetch_group has refilled it
  /// for the present block. Changes rcx and rdx.
  const std::uint8_t* undo_fetch = nullptr;
  /// Subroutine that counts an access to the second memory and the cycles that the access waits. Writable address.
  /// Expects the offset of the access in ecx, and the cycles of the block before the access in edx. If the interpreter
  /// must perform the access, only sets eax to a negative value. Changes rdx. Null if no other core uses the second
  /// memory.
  const std::uint8_t* far = nullptr;
  /// Subroutine that calls Bus::load_quietly(). Writable address. Expects the size in eax, the address in ecx, and the
  /// cycles of the block before the load in edx. Stores the value in HostState::loaded, and returns the wait cycles in
  /// rax. If load_quietly() cannot perform the load, returns a negative value. Changes rdx. Null if Options::perform is
  /// null.
  const std::uint8_t* device = nullptr;
};

/// Exit number of a run that did not end at an exit of a region.
inline constexpr std::uint64_t kNoExit = 0xffffffff;

/// Data that the assembler needs to translate regions.
struct TranslationContext {
  const CodeMemory& code_memory;
  const BlockCache& blocks;
  const FastRegion (&ram)[2];
  const Options& options;
  ExitTable& exits;
};

/// Writes the host code of regions. Lowerings call its parts, which write the code for guest registers, counts, cache
/// lines and edges. Requires the processor features that can_translate() checks. The code uses these registers:
///
///   rbx    Execution
///   r14    bytes of the first fast memory
///   r15    number of cycles up to the limit, counted from the start of the block; costs that are only known at run
///          time are subtracted at once. If banks are shared: the address of the present row of the table of banks,
///          which advances by one row per cycle
///   xmm15  counts: instructions and accesses (32 bits each), energy of instructions [fJ]
///   xmm3 to xmm14  guest registers that dot products and floats use, in the low word; the upper bits have no meaning
///   rax, rcx, rdx, xmm0 to xmm2  scratch; the other registers hold guest registers, zero-extended
class Assembler : public Xbyak::CodeGenerator {
 public:
  /// Writes code at offset `used` of the code memory.
  Assembler(const TranslationContext& context, std::size_t used, const Stubs& stubs);

  /// Defers code that runs often, but not each time. The assembler places it after the region's hot code.
  void defer_warm(std::function<void()> emit) { warm_.push_back(std::move(emit)); }
  /// Defers code that hardly ever runs. The assembler places it last, so that no cache line of the host contains both
  /// hot and cold code.
  void defer_cold(std::function<void()> emit) { cold_.push_back(std::move(emit)); }
  void emit_deferred();

  /// Returns the label of a 16-byte constant. emit_constants() writes all constants.
  const Label& constant(std::uint64_t low, std::uint64_t high) { return constants_[{low, high}]; }
  void emit_constants();

  /// Returns true if code can address `table` relative to r14, which contains the start of the first memory.
  bool is_near(const void* table, std::size_t size) const;
  int from_first_memory(const void* table) const;
  /// Returns the operand for the marks of one or two words of the first memory. ecx must contain the number of the
  /// first word. The written code may change rdx.
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

Stubs emit_stubs(Assembler& a);
/// Writes the code of a region, and returns an entry for each node.
std::vector<Entry> emit_region(Assembler& a, const Region& region);

}  // namespace mebots::soc::translate
