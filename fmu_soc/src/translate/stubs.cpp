// SPDX-License-Identifier: Apache-2.0
//
// The code that all regions share: prologue and epilogue of translated code, the change to the next core of a round,
// refills of the instruction cache, and accesses to a memory that cores share.
#include "hart/data_path.hpp"
#include "mebots/assert.hpp"
#include "translate/assembler.hpp"

#include <array>
#include <bit>

namespace mebots::soc::translate {

using namespace Xbyak::util;

namespace {

constexpr std::size_t kStubAlignment = 16;
/// Aligns the stack for calls, because the return address and six saved registers leave it eight bytes off.
constexpr int kStackPadding = 8;

/// Calls wait_for_far(). Has the calling convention of translated code.
[[gnu::sysv_abi]] std::uint64_t wait_for_far_from_code(Execution& execution, std::uint64_t cycle,
                                                       std::uint32_t offset) noexcept {
  return wait_for_far(execution, cycle, offset);
}

/// Writes the end of a core's run at its limit, after its guest registers were stored. Stores the core's resume point
/// (rdx), and jumps to the resume point of the round's next core (rcx).
void emit_next_core(Assembler& a, const Label& next_core, const Label& done) {
  const auto begin = ptr[rbx + offset_of_host(offsetof(HostState, begin))];
  const auto end = ptr[rbx + offset_of_host(offsetof(HostState, end))];
  const auto resume_point = qword[rbx + offset_of_host(offsetof(HostState, resume_point))];
  const auto next = ptr[rbx + offset_of_host(offsetof(HostState, next))];
  a.mov(resume_point, rdx);
  a.cycles.add_to_counters();
  a.mov(begin, r15);
  a.mov(rsi, end);
  a.mov(rbx, next);
  a.mov(rdx, rbx);
  a.test(rbx, rbx);
  a.jz(done);
  a.mov(end, rsi);
  a.test(rcx, rcx);
  a.jnz(next_core);
  a.mov(eax, static_cast<std::uint32_t>(kNoExit));
  a.jmp(done);
}

/// Writes the call of Options::perform for exit eax, and a jump to the code of the next block. Counts and guest
/// registers must have been stored.
void emit_perform(Assembler& a, const Label& begin, const Label& done) {
  a.mov(rdi, rbx);
  a.mov(esi, eax);
  a.mov(rax, reinterpret_cast<std::uint64_t>(a.options.perform));
  a.sub(rsp, kStackPadding);
  a.call(rax);
  a.add(rsp, kStackPadding);
  a.mov(rcx, rax);
  a.test(rax, rax);
  a.jnz(begin, kNear);
  a.mov(rdx, rbx);
  a.mov(eax, static_cast<std::uint32_t>(kNoExit));
  a.jmp(done, kNear);
}

/// Writes the refill of a line, as InstructionCache::refill() does if the cache has only one user, and counts the wait
/// cycles. The code changes rax, rcx and rdx.
void emit_fetch_stub(Assembler& a) {
  using Cache = InstructionCache;
  static_assert(std::is_standard_layout_v<Cache::State> && std::is_standard_layout_v<Cache::Entry>);
  static_assert(sizeof(Cache::Entry) == 8U << Cache::kWayBit, "a way of the shift register leads to its entry by 8");
  const auto& cache = *a.blocks.fetched();
  MEBOTS_ASSERT(!cache.is_shared());
  MEBOTS_ASSERT(cache.ways() <= 128, "the shift register has eight bits");
  const auto state = [](std::size_t offset) { return rsi + static_cast<int>(offset); };
  a.push(rsi);
  a.push(rdi);
  a.mov(rsi, reinterpret_cast<std::uint64_t>(&cache.state()));
  // rax = the entry for the line. The shift register advances and selects the way within the set.
  a.movzx(edi, byte[state(offsetof(Cache::State, shift_register))]);
  a.movzx(edi, byte[state(offsetof(Cache::State, next_shift)) + rdi]);
  a.mov(byte[state(offsetof(Cache::State, shift_register))], dil);
  a.and_(edi, (cache.ways() - 1) << Cache::kWayBit);
  a.add(rax, ptr[state(offsetof(Cache::State, entries))]);
  a.lea(rax, ptr[rax + rdi * 8]);
  a.inc(qword[state(offsetof(Cache::State, refills))]);
  // Marks the evicted line as absent.
  a.mov(rdi, ptr[rax + static_cast<int>(offsetof(Cache::Entry, present))]);
  a.mov(byte[rdi], 0);
  a.mov(ptr[rax + static_cast<int>(offsetof(Cache::Entry, present))], rcx);
  a.mov(byte[rcx], 1);
  a.mov(dword[rax + static_cast<int>(offsetof(Cache::Entry, line))], edx);
  a.add(qword[rbx + offset_of_counter(offsetof(Counters, fetch_cycles))], cache.refill_cycles());
  a.sub(r15, cache.refill_cycles());
  a.pop(rdi);
  a.pop(rsi);
  a.ret();
}

/// Performs a quiet load, and stores its value in HostState::loaded. Returns the wait cycles, or -1 if the load is not
/// quiet.
[[gnu::sysv_abi]] std::int64_t load_quietly_from_code(Execution& execution, std::uint64_t cycle, std::uint32_t address,
                                                      std::uint32_t size) noexcept {
  auto& data_path = execution.units->data_path;
  if (data_path.is_ram(address, size)) return -1;
  const auto reply = data_path.load_quietly(cycle, address, size);
  if (!reply.is_quiet) return -1;
  execution.host.loaded = reply.value;
  return reply.wait_cycles;
}

/// Writes a call of `function(execution, cycle, ecx, eax)`, whose result is in rax. `cycle` is the cycle of the block's
/// start plus rdx. The code changes only rax and rdx. The function may use floating-point operations.
template <typename Function>
void emit_call(Assembler& a, Function* function) {
  // Saves the registers that a called function may change (System V ABI). Their number keeps the stack aligned.
  const std::array saved{rsi, rdi, r8, r9, r10, r11, rcx};
  constexpr int kVectors = kVectorRegisters;
  constexpr int kRoom = 16 + 8 * kVectors + 8;
  static_assert((8 * std::tuple_size_v<decltype(saved)> + kRoom) % 16 == 0);
  const bool has_floats = a.blocks.extensions().has_floats();
  const int vectors = a.blocks.timing().has_xpulp() || has_floats ? kVectors : 0;
  const auto slot = [](int i) { return ptr[rsp + (16 + 8 * static_cast<std::size_t>(i))]; };
  const auto float_control = dword[rsp + (16 + 8 * kVectors)];
  for (const auto& reg : saved) a.push(reg);
  a.sub(rsp, kRoom);
  a.movdqu(ptr[rsp], xmm15);
  for (int i = 0; i < vectors; ++i) a.movq(slot(i), Xbyak::Xmm(kFirstVector + i));
  if (has_floats) {
    a.stmxcsr(float_control);
    a.ldmxcsr(dword[rbx + offset_of_host(offsetof(HostState, float_control_outside))]);
  }
  a.cycles.copy_counted(rsi);
  a.add(rsi, rdx);
  a.add(rsi, ptr[rbx + offset_of_counter(offsetof(Counters, cycles))]);
  a.mov(rdi, rbx);
  a.mov(edx, ecx);
  a.mov(ecx, eax);
  a.mov(rax, reinterpret_cast<std::uint64_t>(function));
  a.call(rax);
  if (has_floats) a.ldmxcsr(float_control);
  for (int i = 0; i < vectors; ++i) a.movq(Xbyak::Xmm(kFirstVector + i), slot(i));
  a.movdqu(xmm15, ptr[rsp]);
  a.add(rsp, kRoom);
  for (auto reg = saved.rbegin(); reg != saved.rend(); ++reg) a.pop(*reg);
}

/// Writes a call of wait_for_far(), and counts the cycles that it returns.
void emit_far_stub(Assembler& a) {
  MEBOTS_ASSERT(a.options.banks != nullptr, "a core whose second memory is shared shares the first one");
  static_assert(kOutsideBanks >> 63 == 1 && Banks::kReach < std::uint64_t{1} << 31,
                "the sign distinguishes kOutsideBanks from a wait");
  emit_call(a, &wait_for_far_from_code);
  Label left;
  a.test(rax, rax);
  a.js(left);
  a.mov(rdx, rax);
  a.shl(rdx, std::countr_zero(a.options.banks->count()));
  a.add(r15, rdx);
  a.L(left);
  a.ret();
}

}  // namespace

Stubs emit_stubs(Assembler& a) {
  Stubs stubs;
  Label next_core;
  Label limit;
  Label done;

  stubs.prologue = a.code_memory.executable(a.getCurr());
  // The prologue is called with Execution* in rdi and the address of the code in rsi. It returns the number of the exit
  // and an Execution*. It saves the registers that a called function must preserve (System V ABI).
  const std::array saved{rbx, rbp, r12, r13, r14, r15};
  for (const auto& reg : saved) a.push(reg);
  a.mov(rbx, rdi);
  a.mov(rcx, rsi);
  a.mov(r14, ptr[rbx + static_cast<int>(offsetof(Execution, ram[0].data))]);
  const bool has_floats = a.blocks.extensions().has_floats();
  MEBOTS_ASSERT(!has_floats || a.options.banks == nullptr, "a round of cores does not pass flags of floats on");
  if (has_floats) a.stmxcsr(dword[rbx + offset_of_host(offsetof(HostState, float_control_outside))]);
  // Stores the floating-point flags that were raised, and restores the caller's control word.
  const auto leave_floats = [&a] {
    a.stmxcsr(dword[rbx + offset_of_host(offsetof(HostState, float_control_after))]);
    a.ldmxcsr(dword[rbx + offset_of_host(offsetof(HostState, float_control_outside))]);
  };
  a.L(next_core);
  if (has_floats) a.ldmxcsr(dword[rbx + offset_of_host(offsetof(HostState, float_control))]);
  a.mov(r15, ptr[rbx + offset_of_host(offsetof(HostState, begin))]);
  a.pxor(xmm15, xmm15);
  a.mov(qword[rbx + offset_of_host(offsetof(HostState, slow_load))], 0);
  a.jmp(rcx);

  stubs.park = a.getCurr();
  if (a.options.banks != nullptr) {
    a.cmp(r15, ptr[rbx + offset_of_host(offsetof(HostState, end))]);
    a.jae(limit);
  } else {
    a.test(r15, r15);
    a.jle(limit);
  }
  stubs.leave = a.getCurr();
  a.mov(qword[rbx + offset_of_host(offsetof(HostState, resume_point))], 0);
  a.cycles.add_to_counters();
  if (has_floats) leave_floats();
  a.mov(rdx, rbx);
  a.L(done);
  for (auto reg = saved.rbegin(); reg != saved.rend(); ++reg) a.pop(*reg);
  a.ret();

  a.L(limit);
  if (has_floats) leave_floats();  // such a core has no next core
  emit_next_core(a, next_core, done);

  if (a.options.perform != nullptr) {
    stubs.perform = a.getCurr();
    a.cycles.add_to_counters();
    if (has_floats) leave_floats();
    emit_perform(a, next_core, done);
    stubs.device = a.getCurr();
    emit_call(a, &load_quietly_from_code);
    a.ret();
  }
  if (a.blocks.fetched() != nullptr && a.fetches.are_inline()) {
    stubs.fetch = a.getCurr();
    emit_fetch_stub(a);
  }
  if (a.ram[1].is_shared()) {
    stubs.far = a.getCurr();
    emit_far_stub(a);
  }
  a.align(kStubAlignment);
  return stubs;
}

}  // namespace mebots::soc::translate
