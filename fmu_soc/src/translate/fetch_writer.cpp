// SPDX-License-Identifier: Apache-2.0
#include "translate/fetch_writer.hpp"

#include "mebots/assert.hpp"
#include "translate/assembler.hpp"

#include <algorithm>

namespace mebots::soc::translate {

using namespace Xbyak::util;

bool FetchWriter::are_inline() const {
  return !a_.options.loose_limit;
}

/// Writes code that sets the zero flag if the cache line of `address` has not arrived. The code may change rdx.
void FetchWriter::compare_presence(std::uint32_t address) {
  const auto* present = a_.blocks.fetched()->presence(address);
  if (a_.is_near(present, 1)) {
    a_.cmp(byte[r14 + a_.from_first_memory(present)], 0);
  } else {
    a_.mov(rdx, reinterpret_cast<std::uint64_t>(present));
    a_.cmp(byte[rdx], 0);
  }
}

void FetchWriter::jump_when_absent(std::uint32_t address, Label& absent) {
  compare_presence(address);
  a_.je(absent, kNear);
}

/// If cores share the cache, the code leaves the block, and the interpreter fetches the lines. The code may change eax,
/// rcx and rdx.
void FetchWriter::emit(const Block& block, const Instruction* at, const Instruction* before) {
  MEBOTS_ASSERT(a_.blocks.fetched() != nullptr && !is_block_end(at->op));
  const auto& cache = *a_.blocks.fetched();
  const auto last = cache.line_of(at[1].pc - 1);
  for (auto line = cache.line_of(at->pc); line <= last; ++line) {
    if (before != nullptr && line == cache.line_of(before[1].pc - 1)) continue;
    const auto address = std::max(at->pc, cache.address_of(line));
    if (are_inline()) {
      emit_line(line, address, block.is_often_absent());
      continue;
    }
    Label absent;
    jump_when_absent(address, absent);
    a_.defer_cold([this, at, absent]() mutable {
      a_.L(absent);
      Exit exit;
      exit.resumes = true;
      exit.fetches = true;
      exit.at = at;
      exit.wait_cycles = a_.cycles.waits_before(at);
      a_.edges.leave_by(exit);
    });
  }
}

/// Writes code that fetches a line if it is absent. If the line is seldom absent, the refill is placed after the other
/// code of the region. This saves a jump if the line is present, and costs two jumps if it is absent.
void FetchWriter::emit_line(std::uint32_t line, std::uint32_t address, bool often_absent) {
  Label present;
  if (often_absent) {
    compare_presence(address);
    a_.jne(present);
    emit_refill(line, address);
    a_.L(present);
    return;
  }
  Label absent;
  jump_when_absent(address, absent);
  a_.L(present);
  a_.defer_warm([this, line, address, absent, present]() mutable {
    a_.L(absent);
    emit_refill(line, address);
    a_.jmp(present, kNear);
  });
}

/// Writes code that fetches an absent line. The code changes eax, rcx and rdx.
void FetchWriter::emit_refill(std::uint32_t line, std::uint32_t address) {
  MEBOTS_ASSERT(a_.stubs.fetch != nullptr);
  const auto* present = a_.blocks.fetched()->presence(address);
  a_.mov(eax, a_.blocks.fetched()->first_of_set(line));
  a_.mov(edx, line);
  if (a_.is_near(present, 1)) {
    a_.lea(rcx, ptr[r14 + a_.from_first_memory(present)]);
  } else {
    a_.mov(rcx, reinterpret_cast<std::uint64_t>(present));
  }
  a_.call(a_.stubs.fetch);
}

}  // namespace mebots::soc::translate
