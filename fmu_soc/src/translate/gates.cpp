// SPDX-License-Identifier: Apache-2.0
//
// Pieces of code that all regions share: into translated code, out of it, from one core's turn to the next one's.
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
  const auto again = qword[rbx + offset_of_host(offsetof(HostState, again))];
  const auto next = ptr[rbx + offset_of_host(offsetof(HostState, next))];
  Gates gates;
  Label turn;
  Label parks;
  Label done;

  gates.enter = code_memory_.executable(getCurr());
  // (Execution* rdi, code rsi) -> number of the exit, Execution*. Saves what the caller owns (System V ABI).
  const std::array saved{rbx, rbp, r12, r13, r14, r15};
  for (const auto& reg : saved) push(reg);
  mov(rbx, rdi);
  mov(rdx, rsi);
  mov(r14, ptr[rbx + static_cast<int>(offsetof(Execution, ram[0].data))]);
  L(turn);
  mov(r15, begin);
  pxor(xmm15, xmm15);
  mov(qword[rbx + offset_of_host(offsetof(HostState, slow_load))], 0);
  jmp(rdx);

  gates.park = getCurr();
  if (manner_.banks != nullptr) {
    cmp(r15, end);
    jae(parks);
  } else {
    test(r15, r15);
    jle(parks);
  }
  gates.leave = getCurr();
  mov(again, 0);
  emit_account();
  mov(rdx, rbx);
  L(done);
  for (auto reg = saved.rbegin(); reg != saved.rend(); ++reg) pop(*reg);
  ret();

  L(parks);
  mov(again, rdx);
  emit_account();
  mov(begin, r15);
  mov(rcx, end);
  mov(rbx, next);
  mov(rdx, rbx);
  test(rbx, rbx);
  jz(done);
  mov(end, rcx);
  mov(rdx, again);
  test(rdx, rdx);
  jnz(turn);
  mov(eax, static_cast<std::uint32_t>(kNoExit));
  mov(rdx, rbx);
  jmp(done);

  gates.fetch = getCurr();
  emit_fetch_gate();
  align(kGateAlignment);
  return gates;
}

/// Calls Manner::fetch_line and spends what it answers. Keeps all registers of the guest.
void Emitter::emit_fetch_gate() {
  const std::array saved{rsi, rdi, r8, r9, r10, r11};
  for (const auto& reg : saved) push(reg);
  // Translated code runs 8 bytes off an alignment to 16: its call and six registers leave the stack aligned.
  sub(rsp, 16);
  movdqu(ptr[rsp], xmm15);
  mov(rdi, rbx);
  mov(esi, eax);
  add(rdx, ptr[rbx + offset_of_host(offsetof(HostState, begin))]);
  sub(rdx, r15);
  mov(rax, reinterpret_cast<std::uint64_t>(manner_.fetch_line));
  call(rax);
  movdqu(xmm15, ptr[rsp]);
  add(rsp, 16);
  sub(r15, rax);
  for (auto reg = saved.rbegin(); reg != saved.rend(); ++reg) pop(*reg);
  ret();
}

/// Adds what a run has counted to the counters; rcx and rdx are lost.
void Emitter::emit_account() {
  mov(rdx, ptr[rbx + offset_of_host(offsetof(HostState, begin))]);
  sub(rdx, r15);
  if (manner_.banks != nullptr) {
    neg(rdx);
    shr(rdx, std::countr_zero(manner_.banks->count()));
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
  add(ptr[rbx + offset_of_counter(offsetof(Counters, instruction_fj))], rdx);
}

}  // namespace mebots::soc::translate
