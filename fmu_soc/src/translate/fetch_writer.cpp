// SPDX-License-Identifier: Apache-2.0
#include "translate/fetch_writer.hpp"

#include "mebots/assert.hpp"
#include "translate/assembler.hpp"

#include <algorithm>

namespace mebots::soc::translate {

using namespace Xbyak::util;

namespace {

/// Minimum number of lines in a group if the lines are often absent.
constexpr std::uint32_t kLeastAbsent = 4;

}  // namespace

bool FetchWriter::are_inline() const {
  return !a_.options.loose_limit;
}

/// Returns the operand address of presence bytes. May write code that changes rdx.
Xbyak::RegExp FetchWriter::place_of(const std::uint8_t* presence) {
  if (a_.is_near(presence, InstructionCache::kMostGrouped)) return r14 + a_.from_first_memory(presence);
  a_.mov(rdx, reinterpret_cast<std::uint64_t>(presence));
  return rdx + 0;
}

void FetchWriter::jump_when_absent(std::uint32_t address, Label& absent) {
  a_.cmp(byte[place_of(a_.blocks.fetched()->presence(address))], 0);
  a_.je(absent, kNear);
}

/// Returns the group of consecutive lines that begins with `line`, which the instruction `at` needs. A later line is in
/// the group if execution always reaches it, and if no instruction before it uses the number of cycles. If the lines
/// are often absent, a small group has no advantage.
FetchWriter::Group FetchWriter::group_from(const Block& block, std::uint32_t line, const Instruction* at) const {
  const auto& cache = *a_.blocks.fetched();
  // If steps into other functions are recorded, a record contains the refills up to its step. Therefore no line may be
  // fetched early.
  const auto most =
      a_.options.flow != nullptr ? 1U : std::min(InstructionCache::kMostGrouped, cache.lines_before_first_set(line));
  Group group{line, 1};
  for (; !is_block_end(at->op) && group.count < most; ++at) {
    const auto last = cache.line_of(at[1].pc - 1);
    group.count = std::clamp(last - line + 1, group.count, most);
    if (is_branch(at->op) || is_jump(at->op) || is_csr(at->op) || !has_translation(at->op)) break;
  }
  if (block.is_often_absent() && group.count < kLeastAbsent) group.count = 1;
  return group;
}

/// Stores, for each instruction from `at` on, the lines of the group that only later instructions need.
void FetchWriter::note_later_lines(const Group& group, const Instruction* at) {
  const auto& cache = *a_.blocks.fetched();
  const auto all = bits_of(group);
  for (; !is_block_end(at->op); ++at) {
    const auto needed = cache.line_of(at[1].pc - 1) - group.first + 1;
    if (needed >= group.count) break;
    later_lines_[at] = {group, all >> needed << needed};
  }
}

void FetchWriter::emit(const Block& block, const Instruction* at) {
  MEBOTS_ASSERT(a_.blocks.fetched() != nullptr && !is_block_end(at->op));
  if (!are_inline()) {
    emit_shared(at);
    return;
  }
  if (at->index == 0) fetched_end_ = 0;
  const auto& cache = *a_.blocks.fetched();
  const auto last = cache.line_of(at[1].pc - 1);
  for (auto line = cache.line_of(at->pc); line <= last; ++line) {
    if (line < fetched_end_) continue;
    const auto group = group_from(block, line, at);
    note_later_lines(group, at);
    emit_group(group, block.is_often_absent());
    fetched_end_ = std::uint64_t{line} + group.count;
  }
}

void FetchWriter::emit_first(const Block& block, const Instruction* first) {
  MEBOTS_ASSERT(are_inline());
  const auto& cache = *a_.blocks.fetched();
  const auto line = cache.line_of(first->pc);
  const auto last = cache.line_of(first[1].pc - 1);
  for (auto each = line; each <= last; ++each) emit_group({each, 1}, block.is_often_absent());
}

/// For a cache with several users: writes code that leaves to the interpreter if a line of the instruction is absent.
/// The caller has already checked the lines of the block's first instruction.
void FetchWriter::emit_shared(const Instruction* at) {
  if (at->index == 0) return;
  const auto& cache = *a_.blocks.fetched();
  const auto last = cache.line_of(at[1].pc - 1);
  for (auto line = cache.line_of(at->pc); line <= last; ++line) {
    if (line == cache.line_of(at->pc - 1)) continue;
    Label absent;
    jump_when_absent(std::max(at->pc, cache.address_of(line)), absent);
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

/// Writes code that fetches the absent lines of a group. If lines are seldom absent, the code of the refill is placed
/// after the other code of the region. This saves a jump if all lines are present, and costs two jumps otherwise.
void FetchWriter::emit_group(const Group& group, bool often_absent) {
  Label present;
  if (often_absent) {
    jump_on_presence(group, true, present);
    emit_refill(group, bits_of(group));
    a_.L(present);
    return;
  }
  Label absent;
  jump_on_presence(group, false, absent);
  a_.L(present);
  a_.defer_warm([this, group, absent, present]() mutable {
    a_.L(absent);
    emit_refill(group, bits_of(group));
    a_.jmp(present, kNear);
  });
}

/// Writes a jump to `target`. If `present` is true, the jump is taken if all lines of the group are present. Otherwise
/// it is taken if one of them is absent. The code may change rdx and xmm0.
void FetchWriter::jump_on_presence(const Group& group, bool present, const Label& target) {
  const auto& cache = *a_.blocks.fetched();
  const auto place = place_of(cache.presence_by_number() + cache.number_of(group.first));
  if (group.count == 1) {
    a_.cmp(byte[place], 0);
    present ? a_.jne(target) : a_.je(target, kNear);
    return;
  }
  constexpr auto kPresent = std::uint64_t{0x0101010101010101};
  if (group.count == 2) {
    a_.movzx(edx, word[place]);
    a_.cmp(edx, static_cast<std::uint32_t>(kPresent & 0xffffU));
  } else if (group.count == 4) {
    a_.cmp(dword[place], static_cast<std::uint32_t>(kPresent));
  } else {
    // ptest sets the carry flag if all bits of the second operand are also set in the first one.
    const auto bytes_of = [](std::uint32_t count) {
      return kPresent & (count >= 8 ? ~std::uint64_t{0} : (std::uint64_t{1} << 8 * count) - 1);
    };
    a_.movdqu(xmm0, ptr[place]);
    a_.ptest(xmm0, ptr[rip + a_.constant(bytes_of(group.count), bytes_of(group.count < 8 ? 0 : group.count - 8))]);
    present ? a_.jc(target) : a_.jnc(target, kNear);
    return;
  }
  present ? a_.je(target) : a_.jne(target, kNear);
}

/// Writes code that fetches the absent lines of the group, except each line i whose bit i of `bits` is 0. The code
/// changes rax, rcx and rdx.
void FetchWriter::emit_refill(const Group& group, std::uint32_t bits) {
  MEBOTS_ASSERT(a_.stubs.fetch != nullptr && a_.stubs.fetch_group != nullptr);
  const auto& cache = *a_.blocks.fetched();
  a_.mov(ecx, cache.number_of(group.first));
  a_.mov(rdx, reinterpret_cast<std::uint64_t>(cache.first_entry(group.first)));
  if (group.count == 1) {
    a_.call(a_.stubs.fetch);
    return;
  }
  a_.mov(eax, bits);
  a_.call(a_.stubs.fetch_group);
}

void FetchWriter::undo_after(const Instruction* at) {
  const auto later = later_lines_.find(at);
  if (later == later_lines_.end()) return;
  a_.mov(ecx, a_.blocks.fetched()->number_of(later->second.group.first));
  a_.mov(edx, later->second.bits);
  a_.call(a_.stubs.undo_fetch);
}

void FetchWriter::forget_group() {
  if (a_.blocks.fetched() == nullptr || !are_inline()) return;
  a_.mov(rax, reinterpret_cast<std::uint64_t>(&a_.blocks.fetched()->state().group_refilled));
  a_.mov(dword[rax], 0);
}

void FetchWriter::repeat_after(const Instruction* at) {
  const auto later = later_lines_.find(at);
  if (later != later_lines_.end()) emit_refill(later->second.group, later->second.bits);
}

}  // namespace mebots::soc::translate
