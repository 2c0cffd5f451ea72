// SPDX-License-Identifier: Apache-2.0
//
// Pieces of code that all regions share: into translated code, out of it, from one core to the next one of the round;
// what brings a line of code, and what accesses a memory that cores share.
#include "hart/far_access.hpp"
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
  Gates gates;
  Label next_core;
  Label limit;
  Label done;

  gates.enter = code_memory_.executable(getCurr());
  // (Execution* rdi, code rsi) -> number of the exit, Execution*. Saves what the caller owns (System V ABI).
  const std::array saved{rbx, rbp, r12, r13, r14, r15};
  for (const auto& reg : saved) push(reg);
  mov(rbx, rdi);
  mov(rcx, rsi);
  mov(r14, ptr[rbx + static_cast<int>(offsetof(Execution, ram[0].data))]);
  L(next_core);
  mov(r15, ptr[rbx + offset_of_host(offsetof(HostState, begin))]);
  pxor(xmm15, xmm15);
  mov(qword[rbx + offset_of_host(offsetof(HostState, slow_load))], 0);
  jmp(rcx);

  gates.park = getCurr();
  if (options_.banks != nullptr) {
    cmp(r15, ptr[rbx + offset_of_host(offsetof(HostState, end))]);
    jae(limit);
  } else {
    test(r15, r15);
    jle(limit);
  }
  gates.leave = getCurr();
  mov(qword[rbx + offset_of_host(offsetof(HostState, resume_point))], 0);
  emit_account();
  mov(rdx, rbx);
  L(done);
  for (auto reg = saved.rbegin(); reg != saved.rend(); ++reg) pop(*reg);
  ret();

  L(limit);
  emit_next_core(next_core, done);

  if (blocks_.fetched() != nullptr && fetches_inline()) {
    gates.fetch = getCurr();
    emit_fetch_gate();
  }
  if (ram_[1].is_shared()) {
    gates.far = getCurr();
    emit_far_gate();
  }
  align(kGateAlignment);
  return gates;
}

/// Behind a core that came to its limit in translated code: it leaves a resume point, and the next one of the round
/// goes on at its own, rcx. Guest registers are stored.
void Emitter::emit_next_core(const Label& next_core, const Label& done) {
  const auto begin = ptr[rbx + offset_of_host(offsetof(HostState, begin))];
  const auto end = ptr[rbx + offset_of_host(offsetof(HostState, end))];
  const auto resume_point = qword[rbx + offset_of_host(offsetof(HostState, resume_point))];
  const auto next = ptr[rbx + offset_of_host(offsetof(HostState, next))];
  mov(resume_point, rdx);
  emit_account();
  mov(begin, r15);
  mov(rsi, end);
  mov(rbx, next);
  mov(rdx, rbx);
  test(rbx, rbx);
  jz(done);
  mov(end, rsi);
  test(rcx, rcx);
  jnz(next_core);
  mov(eax, static_cast<std::uint32_t>(kNoExit));
  jmp(done);
}

/// InstructionCache::refill for the core that uses it alone; spends what that waits. rax, rcx and rdx are lost.
void Emitter::emit_fetch_gate() {
  using Cache = InstructionCache;
  static_assert(std::is_standard_layout_v<Cache::State> && std::is_standard_layout_v<Cache::Entry>);
  static_assert(sizeof(Cache::Entry) == 8U << Cache::kWayBit, "a way of the shift register leads to its entry by 8");
  const auto& cache = *blocks_.fetched();
  MEBOTS_ASSERT(!cache.is_shared());
  MEBOTS_ASSERT(cache.ways() <= 128, "the shift register has eight bits");
  const auto state = [this](std::size_t offset) { return rsi + static_cast<int>(offset); };
  push(rsi);
  push(rdi);
  mov(rsi, reinterpret_cast<std::uint64_t>(&cache.state()));
  // rax = the entry that the line takes: the shift register moves on, and says which of its set.
  movzx(edi, byte[state(offsetof(Cache::State, shift_register))]);
  movzx(edi, byte[state(offsetof(Cache::State, next_shift)) + rdi]);
  mov(byte[state(offsetof(Cache::State, shift_register))], dil);
  and_(edi, (cache.ways() - 1) << Cache::kWayBit);
  add(rax, ptr[state(offsetof(Cache::State, entries))]);
  lea(rax, ptr[rax + rdi * 8]);
  inc(qword[state(offsetof(Cache::State, refills))]);
  // What was there has left.
  mov(rdi, ptr[rax + static_cast<int>(offsetof(Cache::Entry, present))]);
  mov(byte[rdi], 0);
  mov(ptr[rax + static_cast<int>(offsetof(Cache::Entry, present))], rcx);
  mov(byte[rcx], 1);
  mov(dword[rax + static_cast<int>(offsetof(Cache::Entry, line))], edx);
  add(qword[rbx + offset_of_counter(offsetof(Counters, fetch_cycles))], cache.refill_cycles());
  sub(r15, cache.refill_cycles());
  pop(rdi);
  pop(rsi);
  ret();
}

/// Calls wait_for_far, and spends what it says.
void Emitter::emit_far_gate() {
  MEBOTS_ASSERT(options_.banks != nullptr, "a core whose second memory is shared shares the first one");
  static_assert(kNoRoom >> 63 == 1 && Banks::kReach < std::uint64_t{1} << 31, "the sign tells which it is");
  const auto bits = std::countr_zero(options_.banks->count());
  // What a called function may change (System V ABI), and where an even number of words leaves the stack aligned.
  const std::array saved{rsi, rdi, r8, r9, r10, r11, rcx};
  constexpr int kVectors = kVectorRegisters;
  constexpr int kRoom = 16 + 8 * kVectors + 8;
  static_assert((8 * std::tuple_size_v<decltype(saved)> + kRoom) % 16 == 0);
  for (const auto& reg : saved) push(reg);
  sub(rsp, kRoom);
  movdqu(ptr[rsp], xmm15);
  const auto place = [this](int i) { return ptr[rsp + (16 + 8 * static_cast<std::size_t>(i))]; };
  for (int i = 0; i < kVectors; ++i) movq(place(i), Xbyak::Xmm(kFirstVector + i));
  mov(rsi, r15);
  sub(rsi, ptr[rbx + offset_of_host(offsetof(HostState, begin))]);
  shr(rsi, bits);
  add(rsi, rdx);
  add(rsi, ptr[rbx + offset_of_counter(offsetof(Counters, cycles))]);
  mov(rdi, rbx);
  mov(edx, ecx);
  mov(rax, reinterpret_cast<std::uint64_t>(&wait_for_far));
  call(rax);
  for (int i = 0; i < kVectors; ++i) movq(Xbyak::Xmm(kFirstVector + i), place(i));
  movdqu(xmm15, ptr[rsp]);
  add(rsp, kRoom);
  for (auto reg = saved.rbegin(); reg != saved.rend(); ++reg) pop(*reg);
  Label left;
  test(rax, rax);
  js(left);
  mov(rdx, rax);
  shl(rdx, bits);
  add(r15, rdx);
  L(left);
  ret();
}

/// Adds what a run has counted to the counters. Guest registers are stored; rsi and rdx are lost.
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
  mov(esi, edx);
  add(ptr[rbx + offset_of_counter(offsetof(Counters, instructions))], rsi);
  shr(rdx, 32);
  add(ptr[rbx + offset_of_counter(offsetof(Counters, accesses))], rdx);
  psrldq(xmm15, 8);
  movq(rdx, xmm15);
  if (options_.flow != nullptr) mov(ptr[rbx + offset_of_host(offsetof(HostState, instruction_fj))], rdx);
  add(ptr[rbx + offset_of_counter(offsetof(Counters, instruction_fj))], rdx);
}

}  // namespace mebots::soc::translate
