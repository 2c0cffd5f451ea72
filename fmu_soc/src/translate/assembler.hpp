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

/// Features of the host's processor. They are read when the library is loaded, because each query is slow in a virtual
/// machine.
const Xbyak::util::Cpu& host_processor();

/// A jump with a distance of 32 bits.
inline constexpr auto kNear = Xbyak::CodeGenerator::T_NEAR;

/// Returns the offset of a member of HostState, or of a counter, from the start of Execution.
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

/// Addresses of the pieces of code that all regions share.
struct Stubs {
  const std::uint8_t* prologue = nullptr;  // at its executable address
  const std::uint8_t* leave = nullptr;     // at its writable address; eax = number of the exit
  /// Performs the rare instruction after exit eax (writable address). Null if translated code is left there.
  const std::uint8_t* perform = nullptr;
  /// Parks a core before a block that may not begin (writable address). rdx holds the address of the block's entry; rcx
  /// holds the value that load_next_point() has loaded.
  const std::uint8_t* park = nullptr;
  /// Subroutine (writable address). Fetches line edx into the set whose entries begin at byte offset rax; [rcx] is the
  /// line's presence byte. Null if there is no instruction cache, or if other cores use the cache.
  const std::uint8_t* fetch = nullptr;
  /// Subroutine (writable address). Counts an access at offset ecx of the second memory, and counts the cycles that the
  /// access waits. edx holds the cycles of the block before the access. If the interpreter must perform the access, the
  /// subroutine only sets eax to a negative value. Changes rdx. Null if no other core uses that memory.
  const std::uint8_t* far = nullptr;
  /// Subroutine (writable address). Performs a quiet load of eax bytes at address ecx: see Bus::load_quietly(). edx
  /// holds the cycles of the block before the load. Sets rax to the cycles that the load waits, and HostState::loaded
  /// to the value. If the load is not quiet, sets rax to a negative value. Changes rdx. Null if Options::perform is
  /// null.
  const std::uint8_t* device = nullptr;
};

/// Exit number of a run that ended without an exit of a region.
inline constexpr std::uint64_t kNoExit = 0xffffffff;

/// Inputs of all regions of a translator: memories, blocks and options.
struct TranslationContext {
  const CodeMemory& code_memory;
  const BlockCache& blocks;
  const FastRegion (&ram)[2];
  const Options& options;
  ExitTable& exits;
};

/// The assembler that lowerings write to. Its parts write host code for guest registers, counts, line fetches and
/// edges. Needs a processor with BMI1, BMI2 and LZCNT.
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
  /// Writes host code at offset `used` of the code memory.
  Assembler(const TranslationContext& context, std::size_t used, const Stubs& stubs);

  /// Defers a warm path: code that runs often, but not each time. The assembler places it after the region's hot code.
  void defer_warm(std::function<void()> emit) { warm_.push_back(std::move(emit)); }
  /// Defers a cold path: code that is hardly ever needed. The assembler places it last, so that no line of the host's
  /// caches contains both hot and cold code.
  void defer_cold(std::function<void()> emit) { cold_.push_back(std::move(emit)); }
  void emit_deferred();

  /// Returns the label of a constant of 16 bytes. emit_constants() writes all constants.
  const Label& constant(std::uint64_t low, std::uint64_t high) { return constants_[{low, high}]; }
  void emit_constants();

  /// True if the table can be addressed relative to r14, the start of the first memory.
  bool is_near(const void* table, std::size_t size) const;
  int from_first_memory(const void* table) const;
  /// Returns the operand for the marks of one or two words of the first memory; ecx has the number of the first word.
  /// May change rdx.
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
/// Writes the code of a region. Each of its nodes has an entry.
std::vector<Entry> emit_region(Assembler& a, const Region& region);

}  // namespace mebots::soc::translate
