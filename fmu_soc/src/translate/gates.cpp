// SPDX-License-Identifier: Apache-2.0
//
// Pieces of code that all regions share: into translated code, out of it, from one core to the next one of the round.
#include "mebots/assert.hpp"
#include "translate/emitter.hpp"

#include <array>
#include <bit>

namespace mebots::soc::translate {
namespace {

constexpr std::size_t kGateAlignment = 16;

constexpr int offset_of_host(std::size_t member) {
  return static_cast<int>(offsetof(Execution, host) + member);
}

constexpr int offset_of_counter(std::size_t member) {
  return static_cast<int>(offsetof(Execution, counters) + member);
}

}  // namespace

Emitter::Gates Emitter::emit_gates() {
  const auto begin = ptr[rbx + offset_of_host(offsetof(HostState, begin))];
  const auto end = ptr[rbx + offset_of_host(offsetof(HostState, end))];
  const auto resume_point = qword[rbx + offset_of_host(offsetof(HostState, resume_point))];
  const auto next = ptr[rbx + offset_of_host(offsetof(HostState, next))];
  Gates gates;
  Label next_core;
  Label parks;
  Label done;

  gates.enter = code_memory_.executable(getCurr());
  // (Execution* rdi, code rsi) -> number of the exit, Execution*. Saves what the caller owns (System V ABI).
  const std::array saved{rbx, rbp, r12, r13, r14, r15};
  for (const auto& reg : saved) push(reg);
  mov(rbx, rdi);
  mov(rdx, rsi);
  mov(r14, ptr[rbx + static_cast<int>(offsetof(Execution, ram[0].data))]);
  L(next_core);
  mov(r15, begin);
  pxor(xmm15, xmm15);
  mov(qword[rbx + offset_of_host(offsetof(HostState, slow_load))], 0);
  jmp(rdx);

  gates.park = getCurr();
  if (options_.banks != nullptr) {
    cmp(r15, end);
    jae(parks);
  } else {
    test(r15, r15);
    jle(parks);
  }
  gates.leave = getCurr();
  mov(resume_point, 0);
  emit_account();
  mov(rdx, rbx);
  L(done);
  for (auto reg = saved.rbegin(); reg != saved.rend(); ++reg) pop(*reg);
  ret();

  L(parks);
  mov(resume_point, rdx);
  emit_account();
  mov(begin, r15);
  mov(rcx, end);
  mov(rbx, next);
  mov(rdx, rbx);
  test(rbx, rbx);
  jz(done);
  mov(end, rcx);
  mov(rdx, resume_point);
  test(rdx, rdx);
  jnz(next_core);
  mov(eax, static_cast<std::uint32_t>(kNoExit));
  mov(rdx, rbx);
  jmp(done);

  if (cache_.fetched() != nullptr && fetches_inline()) {
    gates.fetch = getCurr();
    emit_fetch_gate();
  }
  align(kGateAlignment);
  return gates;
}

/// InstructionCache::refill in the cycle in which an instruction is reached; spends what it waits. eax, rcx and rdx are
/// lost.
void Emitter::emit_fetch_gate() {
  using Cache = InstructionCache;
  static_assert(std::is_standard_layout_v<Cache::State> && std::is_standard_layout_v<Cache::Entry>);
  static_assert(sizeof(Cache::Entry) == 16);
  const auto& cache = *cache_.fetched();
  MEBOTS_ASSERT(cache.ways() <= 128, "the shift register has eight bits");
  const auto state = [this](std::size_t offset) { return rsi + static_cast<int>(offset); };
  const std::array saved{rsi, rdi, r8};
  Label is_last;
  for (const auto& reg : saved) push(reg);
  mov(rsi, reinterpret_cast<std::uint64_t>(&cache.state()));
  // rdx = when the line has arrived.
  add(rdx, ptr[rbx + offset_of_host(offsetof(HostState, begin))]);
  sub(rdx, r15);
  add(rdx, ptr[rbx + offset_of_counter(offsetof(Counters, cycles))]);
  add(rdx, ptr[rbx + offset_of_host(offsetof(HostState, tick_offset))]);
  add(rdx, cache.refill_cycles());
  // r8 = the entry that it takes: the shift register moves on, and says which of its set.
  movzx(edi, byte[state(offsetof(Cache::State, shift_register))]);
  test(edi, Cache::kTaps);
  setp(r8b);
  movzx(r8d, r8b);
  lea(edi, ptr[r8 + rdi * 2]);
  mov(byte[state(offsetof(Cache::State, shift_register))], dil);
  shr(edi, 1);
  and_(edi, cache.ways() - 1);
  mov(r8d, eax);
  and_(r8d, cache.set_mask());
  shl(r8d, std::countr_zero(cache.ways()));
  add(r8d, edi);
  mov(rdi, ptr[state(offsetof(Cache::State, present))]);
  lea(rdi, ptr[rdi + r8 * 8]);
  shl(r8, std::countr_zero(sizeof(Cache::Entry)));
  add(r8, ptr[state(offsetof(Cache::State, entries))]);
  mov(dword[r8 + static_cast<int>(offsetof(Cache::Entry, line))], eax);
  mov(qword[r8 + static_cast<int>(offsetof(Cache::Entry, ready))], rdx);
  // What was there has left.
  mov(rax, ptr[rdi]);
  mov(byte[rax], 0);
  mov(ptr[rdi], rcx);
  mov(byte[rcx], 1);
  cmp(rdx, ptr[state(offsetof(Cache::State, settled))]);
  jbe(is_last);
  mov(ptr[state(offsetof(Cache::State, settled))], rdx);
  L(is_last);
  inc(qword[state(offsetof(Cache::State, refills))]);
  add(qword[rbx + offset_of_counter(offsetof(Counters, fetch_cycles))], cache.refill_cycles());
  sub(r15, cache.refill_cycles());
  for (auto reg = saved.rbegin(); reg != saved.rend(); ++reg) pop(*reg);
  ret();
}

/// Adds what a run has counted to the counters; rcx and rdx are lost.
void Emitter::emit_account() {
  if (options_.flow != nullptr) mov(ptr[rbx + offset_of_host(offsetof(HostState, position))], r15);
  mov(rdx, ptr[rbx + offset_of_host(offsetof(HostState, begin))]);
  sub(rdx, r15);
  if (options_.banks != nullptr) {
    neg(rdx);
    shr(rdx, std::countr_zero(options_.banks->count()));
  }
  add(ptr[rbx + offset_of_counter(offsetof(Counters, cycles))], rdx);
  movq(rdx, xmm15);
  mov(ptr[rbx + offset_of_host(offsetof(HostState, instructions))], rdx);
  mov(ecx, edx);
  add(ptr[rbx + offset_of_counter(offsetof(Counters, instructions))], rcx);
  shr(rdx, 32);
  add(ptr[rbx + offset_of_counter(offsetof(Counters, accesses))], rdx);
  psrldq(xmm15, 8);
  movq(rdx, xmm15);
  if (options_.flow != nullptr) mov(ptr[rbx + offset_of_host(offsetof(HostState, instruction_fj))], rdx);
  add(ptr[rbx + offset_of_counter(offsetof(Counters, instruction_fj))], rdx);
}

}  // namespace mebots::soc::translate
