// SPDX-License-Identifier: Apache-2.0
#include "translate/cycle_accounting.hpp"

#include "mebots/assert.hpp"
#include "translate/assembler.hpp"

#include <bit>

namespace mebots::soc::translate {

using namespace Xbyak::util;

std::uint32_t CycleAccounting::waits_before(const Instruction* at) const {
  return a_.ram[0].wait_cycles * at->accesses_before;
}

void CycleAccounting::count(const Instruction* at, std::uint32_t extra_cycles) {
  MEBOTS_ASSERT(at[1].index == at->index + 1 && at[1].cycles_before >= at->cycles_before);
  const auto& sums = at[1];
  spend(sums.cycles_before + waits_before(&sums) + extra_cycles);
  const auto counts = std::uint64_t{sums.index} | std::uint64_t{sums.accesses_before} << 32;
  a_.paddq(xmm15, ptr[rip + a_.constant(counts, sums.energy_before_fj)]);
}

void CycleAccounting::take_back(const Instruction* at) {
  MEBOTS_ASSERT(at[1].index == at->index + 1);
  const auto& sums = at[1];
  const auto cycles = sums.cycles_before + waits_before(&sums);
  if (a_.options.banks != nullptr) {
    a_.sub(r15, cycles * a_.options.banks->count());
  } else {
    a_.add(r15, cycles);
  }
  const auto counts = std::uint64_t{sums.index} | std::uint64_t{sums.accesses_before} << 32;
  a_.psubq(xmm15, ptr[rip + a_.constant(counts, sums.energy_before_fj)]);
}

void CycleAccounting::spend(std::uint32_t cycles) {
  if (cycles == 0) return;
  if (a_.options.banks != nullptr) {
    a_.add(r15, cycles * a_.options.banks->count());
  } else {
    a_.sub(r15, cycles);
  }
}

void CycleAccounting::spend(const Xbyak::Reg64& cycles) {
  if (a_.options.banks != nullptr) {
    a_.shl(cycles.cvt32(), std::countr_zero(a_.options.banks->count()));
    a_.add(r15, cycles);
  } else {
    a_.sub(r15, cycles);
  }
}

/// If blocks must not run past the limit, the code jumps if the block's last instruction might start at or after the
/// limit. If they may (loose limit), the code jumps if the limit is already reached. It also jumps if other cores use
/// the instruction cache and a line of the first instruction is absent.
void CycleAccounting::jump_at_limit(const Block& block, std::uint32_t stall, Label& leave) {
  if (!a_.options.loose_limit) {
    a_.cmp(r15, a_.blocks.fetch_bound(block) + stall);
    a_.jle(leave, kNear);
  } else if (a_.options.banks != nullptr) {
    a_.cmp(r15, ptr[rbx + static_cast<int>(offsetof(Execution, host.end))]);
    a_.jae(leave, kNear);
  } else {
    a_.cmp(r15, 0);
    a_.jle(leave, kNear);
  }
  if (a_.blocks.fetched() != nullptr && !a_.fetches.are_inline()) {
    a_.fetches.jump_when_absent(block.pc, leave);
    if (block.begins_across) a_.fetches.jump_when_absent(block.pc + 2, leave);
  }
}

void CycleAccounting::jump_if_stalled(const Instruction* at, std::uint64_t stalled_by, Label& stalled) {
  if (at->index != 0 || stalled_by == 0) return;
  // In the first block of a run, always jumps: the previous instruction is in Execution::pipeline, which the code does
  // not check.
  a_.movd(ecx, xmm15);
  a_.test(ecx, ecx);
  a_.jz(stalled, kNear);
  constexpr auto kWritten =
      offsetof(HostState, straight_pipeline) + offsetof(Pipeline, before) + offsetof(Previous, rd);
  a_.movzx(ecx, byte[rbx + offset_of_host(kWritten)]);
  a_.mov(rdx, stalled_by);
  a_.bt(rdx, rcx);
  a_.jc(stalled, kNear);
}

void CycleAccounting::copy_counted(const Xbyak::Reg64& to) {
  const auto begin = ptr[rbx + offset_of_host(offsetof(HostState, begin))];
  if (a_.options.banks != nullptr) {
    a_.mov(to, r15);
    a_.sub(to, begin);
    a_.shr(to, std::countr_zero(a_.options.banks->count()));
  } else {
    a_.mov(to, begin);
    a_.sub(to, r15);
  }
}

void CycleAccounting::copy_start_of(const Instruction* at, const Xbyak::Reg64& to) {
  copy_counted(to);
  a_.add(to, ptr[rbx + offset_of_counter(offsetof(Counters, cycles))]);
  if (const auto before = at->cycles_before + waits_before(at); before != 0) a_.add(to, before);
}

bool CycleAccounting::is_noted(const Instruction* at, std::uint32_t next) const {
  if (a_.options.flow == nullptr) return false;
  return (at->op == Op::jal && at->rd != kNoRegister) || a_.options.flow->may_leave_function(at->pc, next);
}

/// Writes code that records a step from the instruction `at` to another one: see Flow. `set_next` writes the code that
/// stores the target. All instructions up to `at` must have been counted. The code changes rcx and rdx.
template <typename SetNext>
void CycleAccounting::record_flow(const Instruction* at, SetNext set_next) {
  MEBOTS_ASSERT(a_.options.flow != nullptr);
  const auto field = [this](std::size_t offset) { return rdx + static_cast<int>(offset); };
  const auto end = rbx + static_cast<int>(offsetof(Execution, host.flow));
  a_.mov(rdx, ptr[end]);
  a_.movdqu(ptr[field(offsetof(Flow, instructions))], xmm15);
  a_.mov(ptr[field(offsetof(Flow, cycles))], r15);
  a_.mov(rcx, ptr[rbx + static_cast<int>(offsetof(Execution, counters.far_accesses))]);
  a_.mov(ptr[field(offsetof(Flow, far_accesses))], rcx);
  a_.mov(rcx, ptr[rbx + static_cast<int>(offsetof(Execution, counters.fetch_cycles))]);
  a_.mov(ptr[field(offsetof(Flow, fetch_cycles))], rcx);
  a_.mov(rcx, reinterpret_cast<std::uint64_t>(at));
  a_.mov(ptr[field(offsetof(Flow, at))], rcx);
  set_next(dword[field(offsetof(Flow, next))]);
  a_.add(qword[end], static_cast<std::uint32_t>(sizeof(Flow)));
}

void CycleAccounting::record_flow_to(const Instruction* at, std::uint32_t next) {
  record_flow(at, [this, next](const Xbyak::Address& place) { a_.mov(place, next); });
}

/// Writes code that records the step from the instruction `at` to the address in register `next`: see Flow.
void CycleAccounting::record_flow_to(const Instruction* at, const Xbyak::Reg32& next) {
  record_flow(at, [this, next](const Xbyak::Address& place) { a_.mov(place, next); });
}

/// Writes code that records the step from `at` to the next instruction of the block. The code counts the block's
/// instructions up to `at` before it records the step, and subtracts them afterwards.
void CycleAccounting::record_flow_inside(const Instruction* at) {
  if (is_block_end(at[1].op) || !is_noted(at, at[1].pc)) return;
  count(at, 0);
  record_flow_to(at, at[1].pc);
  take_back(at);
}

/// Writes code that claims the bank of an access, if the memory has banks that cores share. If `word_in_ecx` is true,
/// ecx must contain the number of the word. Otherwise eax must contain the offset of the access. The code changes ecx
/// and rdx.
void CycleAccounting::claim_bank(const Instruction* at, bool word_in_ecx) {
  if (a_.options.banks == nullptr) return;
  const auto count = static_cast<int>(a_.options.banks->count());
  const auto distance = at->cycles_before * count;
  MEBOTS_ASSERT(std::has_single_bit(static_cast<unsigned>(count)), "the low bits of a word's number say its bank");
  Label retry;
  Label taken;
  Label done;
  if (!word_in_ecx) a_.rorx(ecx, eax, 2);
  a_.and_(ecx, count - 1);
  a_.L(retry);
  a_.cmp(byte[r15 + rcx + distance], 0);
  a_.jne(taken, kNear);
  a_.mov(byte[r15 + rcx + distance], 1);
  a_.L(done);
  a_.defer_warm([this, retry, taken, done, count, distance]() mutable {
    a_.L(taken);
    a_.cmp(byte[rbx + offset_of_host(offsetof(HostState, alone))], 0);
    a_.jne(done, kNear);
    a_.add(r15, count);
    a_.mov(rdx, reinterpret_cast<std::uint64_t>(a_.options.banks->horizon()));
    a_.mov(rdx, ptr[rdx]);
    a_.sub(rdx, distance);
    a_.cmp(r15, rdx);
    a_.jb(retry, kNear);
    a_.jmp(done, kNear);
  });
}

/// Guest registers must have been stored before, because the code changes rsi, which may hold one, and rdx.
void CycleAccounting::add_to_counters() {
  if (a_.options.flow != nullptr) a_.mov(ptr[rbx + offset_of_host(offsetof(HostState, position))], r15);
  copy_counted(rdx);
  a_.add(ptr[rbx + offset_of_counter(offsetof(Counters, cycles))], rdx);
  a_.movq(rdx, xmm15);
  a_.mov(ptr[rbx + offset_of_host(offsetof(HostState, instructions))], rdx);
  a_.mov(esi, edx);
  a_.add(ptr[rbx + offset_of_counter(offsetof(Counters, instructions))], rsi);
  a_.shr(rdx, 32);
  a_.add(ptr[rbx + offset_of_counter(offsetof(Counters, accesses))], rdx);
  a_.psrldq(xmm15, 8);
  a_.movq(rdx, xmm15);
  if (a_.options.flow != nullptr) a_.mov(ptr[rbx + offset_of_host(offsetof(HostState, instruction_fj))], rdx);
  a_.add(ptr[rbx + offset_of_counter(offsetof(Counters, instruction_fj))], rdx);
}

}  // namespace mebots::soc::translate
