// SPDX-License-Identifier: Apache-2.0
//
// The code that all regions share: prologue and epilogue of translated code, the change to the hart that runs next,
// refills of the instruction cache, and accesses to a memory that cores share.
#include "hart/data_path.hpp"
#include "mebots/assert.hpp"
#include "translate/assembler.hpp"

#include <array>
#include <bit>
#include <initializer_list>
#include <vector>

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
/// (rdx), and jumps to the resume point of the core that runs after it (rcx).
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

/// Writes the call of Options::perform for the exit whose number is in eax, and a jump to the code of the next block.
/// Counts and guest registers must have been stored.
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

/// Writes the instructions with which stubs access the state of an instruction cache that has one user.
class CacheAccess {
 public:
  using Cache = InstructionCache;
  CacheAccess(Assembler& assembler, const Xbyak::Reg64& state, const Xbyak::Reg64& far_presence)
      : a_(assembler), cache_(*a_.blocks.fetched()), state_(state), far_presence_(far_presence) {
    static_assert(std::is_standard_layout_v<Cache::State>);
    MEBOTS_ASSERT(!cache_.is_shared());
  }
  /// Writes code that saves these registers, and `far_presence` if it is needed. The code then loads the addresses of
  /// the cache's state and of its presence bytes.
  void begin(std::initializer_list<Xbyak::Reg64> saved) {
    saved_ = saved;
    if (!is_near()) saved_.push_back(far_presence_);
    for (const auto& reg : saved_) a_.push(reg);
    a_.mov(state_, reinterpret_cast<std::uint64_t>(&cache_.state()));
    if (!is_near()) a_.mov(far_presence_, reinterpret_cast<std::uint64_t>(cache_.presence_by_number()));
  }
  void end() const {
    for (auto reg = saved_.rbegin(); reg != saved_.rend(); ++reg) a_.pop(*reg);
    a_.ret();
  }
  Xbyak::RegExp field(std::size_t offset) const { return state_ + static_cast<int>(offset); }
  /// Returns the address of the presence byte of the line whose number is in the register `number`.
  Xbyak::RegExp presence(const Xbyak::Reg64& number) const {
    if (!is_near()) return far_presence_ + number;
    return r14 + number + a_.from_first_memory(cache_.presence_by_number());
  }
  std::uint32_t refill_cycles() const { return cache_.refill_cycles(); }

 private:
  bool is_near() const { return a_.is_near(cache_.presence_by_number(), 1); }

  Assembler& a_;
  const Cache& cache_;
  Xbyak::Reg64 state_;
  Xbyak::Reg64 far_presence_;
  std::vector<Xbyak::Reg64> saved_;
};

/// Writes the subroutine Stubs::fetch. It refills a line as InstructionCache::refill() does if the cache has only one
/// user, and counts the wait cycles.
void emit_fetch_stub(Assembler& a) {
  using Cache = InstructionCache;
  CacheAccess cache(a, rsi, r8);
  cache.begin({rsi, rdi});
  Label repeats;
  a.mov(edi, dword[cache.field(offsetof(Cache::State, shifts))]);
  a.mov(eax, dword[cache.field(offsetof(Cache::State, way_offsets)) + rdi * 4]);
  a.inc(edi);
  a.cmp(edi, Cache::kShiftPeriod);
  a.je(repeats);
  Label advanced;
  a.L(advanced);
  a.mov(dword[cache.field(offsetof(Cache::State, shifts))], edi);
  a.add(rdx, rax);
  a.mov(eax, dword[rdx]);
  a.mov(byte[cache.presence(rax)], 0);
  a.mov(dword[rdx], ecx);
  a.mov(byte[cache.presence(rcx)], 1);
  a.inc(qword[cache.field(offsetof(Cache::State, refills))]);
  a.add(qword[rbx + offset_of_counter(offsetof(Counters, fetch_cycles))], cache.refill_cycles());
  a.sub(r15, cache.refill_cycles());
  cache.end();
  a.L(repeats);
  a.xor_(edi, edi);
  a.jmp(advanced);
}

/// Writes the subroutine Stubs::fetch_group. It refills the absent lines of a group in their order, and counts the wait
/// cycles. The lines are in different sets. The subroutine stores the data with which InstructionCache::undo_refills()
/// can undo the refills.
void emit_fetch_group_stub(Assembler& a) {
  using Cache = InstructionCache;
  CacheAccess cache(a, rsi, r11);
  cache.begin({rsi, rdi, r8, r9, r10});
  const auto field = [&cache](std::size_t offset) { return cache.field(offset); };
  // eax = the requested lines that are absent, which may be none. The presence byte of a present line is 1.
  a.movdqu(xmm0, ptr[cache.presence(rcx)]);
  a.psllw(xmm0, 7);
  a.pmovmskb(edi, xmm0);
  a.andn(eax, edi, eax);
  Label none;
  a.jz(none, kNear);
  a.movq(ptr[field(offsetof(Cache::State, group_when))], xmm15);
  a.mov(dword[field(offsetof(Cache::State, group))], ecx);
  a.mov(dword[field(offsetof(Cache::State, group_refilled))], eax);
  a.popcnt(edi, eax);
  a.add(qword[field(offsetof(Cache::State, refills))], rdi);
  a.mov(r8d, dword[field(offsetof(Cache::State, shifts))]);
  a.mov(dword[field(offsetof(Cache::State, group_shifts))], r8d);
  a.lea(r9d, ptr[r8 + rdi]);
  a.lea(r10d, ptr[r9 - static_cast<int>(Cache::kShiftPeriod)]);
  a.cmp(r9d, Cache::kShiftPeriod);
  a.cmovae(r9d, r10d);
  a.mov(dword[field(offsetof(Cache::State, shifts))], r9d);
  a.imul(edi, edi, static_cast<int>(cache.refill_cycles()));
  a.sub(r15, rdi);
  a.add(qword[rbx + offset_of_counter(offsetof(Counters, fetch_cycles))], rdi);
  a.lea(r8, ptr[field(offsetof(Cache::State, way_offsets)) + r8 * 4]);
  Label next;
  a.L(next);
  a.tzcnt(r9d, eax);
  a.mov(edi, dword[r8]);
  a.add(r8, sizeof(std::uint32_t));
  a.add(rdi, rdx);
  a.mov(r10d, dword[rdi + r9 * 4]);
  a.mov(byte[cache.presence(r10)], 0);
  a.mov(dword[field(offsetof(Cache::State, group_evicted)) + r9 * 4], r10d);
  a.lea(r10d, ptr[rcx + r9]);
  a.mov(dword[rdi + r9 * 4], r10d);
  a.mov(byte[cache.presence(r10)], 1);
  a.blsr(eax, eax);
  a.jnz(next);
  a.L(none);
  cache.end();
}

/// Undoes the refills of these lines of the group that was refilled last. Returns the cycles that the core has waited
/// for them.
[[gnu::sysv_abi]] std::uint64_t undo_fetch_from_code(Execution& execution, std::uint64_t /*cycle*/, std::uint32_t lines,
                                                     std::uint32_t /*unused*/) noexcept {
  return execution.units->fetch.undo_refills(lines);
}

/// Calls DataPath::load_quietly(), and stores the value in HostState::loaded. Returns the wait cycles, or -1 if
/// load_quietly() cannot perform the load.
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

/// Writes the subroutine Stubs::undo_fetch. It undoes refills for instructions that the block does not reach now.
void emit_undo_fetch_stub(Assembler& a) {
  using Cache = InstructionCache;
  const CacheAccess cache(a, rsi, rsi);
  const auto field = [&cache](std::size_t offset) { return cache.field(offset); };
  Label none;
  a.push(rax);
  a.push(rsi);
  a.mov(rsi, reinterpret_cast<std::uint64_t>(&a.blocks.fetched()->state()));
  a.cmp(dword[field(offsetof(Cache::State, group))], ecx);
  a.jne(none, kNear);
  a.movq(rax, xmm15);
  a.cmp(ptr[field(offsetof(Cache::State, group_when))], rax);
  a.jne(none, kNear);
  a.mov(ecx, edx);
  a.and_(ecx, dword[field(offsetof(Cache::State, group_refilled))]);
  a.jz(none, kNear);
  emit_call(a, &undo_fetch_from_code);
  a.add(r15, rax);
  a.L(none);
  a.pop(rsi);
  a.pop(rax);
  a.ret();
}

/// Writes the subroutine Stubs::far. It calls wait_for_far(), and counts the cycles that this function returns.
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
  a.fetches.forget_group();
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
    stubs.fetch_group = a.getCurr();
    emit_fetch_group_stub(a);
    stubs.undo_fetch = a.getCurr();
    emit_undo_fetch_stub(a);
  }
  if (a.ram[1].is_shared()) {
    stubs.far = a.getCurr();
    emit_far_stub(a);
  }
  a.align(kStubAlignment);
  return stubs;
}

}  // namespace mebots::soc::translate
