// SPDX-License-Identifier: Apache-2.0
//
// Control and status registers: those of machine mode that CV32E40P has; with Xpulp also RI5CY's own. All others trap.
#include "hart/csrs.hpp"

#include "hart/csr_numbers.hpp"

namespace mebots::soc {
namespace {

constexpr std::uint32_t kMisaValue = (1U << 30) | (1U << 8) | (1U << 12) | (1U << 2);  // RV32, I, M, C
constexpr std::uint32_t kMieBit = 1U << 3;
constexpr std::uint32_t kMpieBit = 1U << 7;
constexpr std::uint32_t kMppMachine = 3U << 11;
constexpr std::uint32_t kInhibitCycle = 1U << 0;
constexpr std::uint32_t kInhibitInstret = 1U << 2;
/// Software, timer and external interrupt of machine mode, and 16 fast lines.
constexpr std::uint32_t kInterruptLines = 0xffff0000U | (1U << 11) | (1U << 7) | (1U << 3);
/// JEDEC number of the OpenHW Group and architecture number of CV32E40P; GAP8's RI5CY says the same kind of thing.
constexpr std::uint32_t kVendor = 0x602;
constexpr std::uint32_t kArchitecture = 4;

bool inside(unsigned number, unsigned first, unsigned count) {
  return number >= first && number < first + count;
}

/// Event counters 3 to 31 and their selectors: there, always 0.
bool is_zero_register(unsigned number) {
  return inside(number, csr::kMhpmevent3, 29) || inside(number, csr::kMhpmcounter3, 29) ||
         inside(number, csr::kMhpmcounter3h, 29) || inside(number, csr::kHpmcounter3, 29) ||
         inside(number, csr::kHpmcounter3h, 29);
}

constexpr std::uint32_t kCountersOn = 1U << 0;      // PCMR
constexpr std::uint32_t kCountersStop = 1U << 1;    // at their highest value
constexpr std::uint32_t kEvents = (1U << 31) - 1U;  // of PCER
constexpr std::uint32_t kMachineMode = 3;

bool is_event_counter(unsigned number) {
  return inside(number, csr::kPccr, csr::kPccrAll - csr::kPccr + 1);
}

}  // namespace

void Csrs::restart() {
  state_ = {};
  if (has_event_unit_) state_.mie = ~0U;
  state_.cycle_base = execution_.counters.cycles;
  state_.instret_base = execution_.counters.instructions;
  interrupt_ready_ = false;
}

void Csrs::set_interrupt(unsigned bit, bool level) {
  const auto mask = 1U << bit;
  set_interrupts(level ? state_.mip | mask : state_.mip & ~mask);
}

void Csrs::set_interrupts(std::uint32_t lines) {
  state_.mip = lines;
  update_interrupts();
}

void Csrs::update_interrupts() {
  interrupt_ready_ = state_.interrupts_on && pending() != 0;
  if (interrupt_ready_) execution_.drop_resume_point();
}

void Csrs::enter_handler(std::uint32_t cause, std::uint32_t value) {
  state_.mepc = execution_.pc;
  state_.mcause = cause;
  state_.mtval = value;
  state_.interrupts_were_on = state_.interrupts_on;
  state_.interrupts_on = false;
  update_interrupts();
}

std::uint32_t Csrs::leave_handler() {
  state_.interrupts_on = state_.interrupts_were_on;
  state_.interrupts_were_on = true;
  update_interrupts();
  return state_.mepc;
}

const Instruction* Csrs::access(const Instruction* at) {
  auto& e = execution_;
  const auto number = static_cast<unsigned>(at->imm);
  const bool immediate = traits_of(at->op).kind == OpKind::csr_immediate;
  const auto operand = immediate ? at->rs1 : e.x[at->rs1];
  const bool replace = at->op == Op::csrrw || at->op == Op::csrrwi;
  const bool set = at->op == Op::csrrs || at->op == Op::csrrsi;
  // Set and clear with x0 (or 0) only read; replace into x0 only writes.
  // RI5CY's event counters are written back even then, in the place of what this instruction would have counted.
  const bool writes = replace || at->rs1 != 0 || (timing_.has_xpulp() && is_event_counter(number));
  const bool read_only = (number >> 10) == 3;

  // Counters count what retired before this instruction.
  const auto saved = e.counters;
  e.counters.instructions += at->index;
  e.counters.cycles = e.start_of(at);
  std::uint32_t old = 0;
  bool good = read(number, old) && !(writes && read_only);
  if (good && writes) good = write(number, replace ? operand : set ? old | operand : old & ~operand);
  e.counters = saved;
  if (!good) return e.raise(at, cause::kIllegalInstruction, cache_.word_at(at->pc).value_or(0));
  e.x[at->rd] = old;
  return cache_.is_stale() ? e.leave_after(at, Leave::normal) : at + 1;  // it has set where a hardware loop ends
}

bool Csrs::read(unsigned number, std::uint32_t& value) const {
  value = 0;
  switch (number) {
    case csr::kMstatus:
      value = kMppMachine | (state_.interrupts_on ? kMieBit : 0U) | (state_.interrupts_were_on ? kMpieBit : 0U);
      return true;
    case csr::kMisa:
      value = kMisaValue;
      return true;
    case csr::kMie:
      value = state_.mie;
      return true;
    case csr::kMtvec:
      value = state_.mtvec;
      return true;
    case csr::kMcountinhibit:
      value = state_.mcountinhibit;
      return true;
    case csr::kMscratch:
      value = state_.mscratch;
      return true;
    case csr::kMepc:
      value = state_.mepc;
      return true;
    case csr::kMcause:
      value = state_.mcause;
      return true;
    case csr::kMtval:
      value = state_.mtval;
      return true;
    case csr::kMip:
      value = state_.mip;
      return true;
    case csr::kMcycle:
    case csr::kCycle:
      value = static_cast<std::uint32_t>(read_counter(false));
      return true;
    case csr::kMcycleh:
    case csr::kCycleh:
      value = static_cast<std::uint32_t>(read_counter(false) >> 32);
      return true;
    case csr::kMinstret:
    case csr::kInstret:
      value = static_cast<std::uint32_t>(read_counter(true));
      return true;
    case csr::kMinstreth:
    case csr::kInstreth:
      value = static_cast<std::uint32_t>(read_counter(true) >> 32);
      return true;
    case csr::kMvendorid:
      value = kVendor;
      return true;
    case csr::kMarchid:
      value = kArchitecture;
      return true;
    case csr::kMimpid:
      return true;
    case csr::kMhartid:
      value = id_;
      return true;
    default:
      return is_zero_register(number) || (timing_.has_xpulp() && read_ri5cy(number, value));
  }
}

bool Csrs::read_ri5cy(unsigned number, std::uint32_t& value) const {
  const auto& loops = execution_.loops;
  if (inside(number, csr::kLoopStart0, 3) || inside(number, csr::kLoopStart1, 3)) {
    const auto& loop = loops[number < csr::kLoopStart1 ? 0 : 1];
    const auto which = (number - csr::kLoopStart0) & 3U;
    value = which == 0 ? loop.start : which == 1 ? loop.end : loop.count;
    return true;
  }
  switch (number) {
    case csr::kPccr:
    case csr::kPccr + 1:
      value = read_event_counter(number - csr::kPccr);
      return true;
    case csr::kPcer:
      value = state_.pcer;
      return true;
    case csr::kPcmr:
      value = state_.pcmr;
      return true;
    case csr::kPrivilege:
      value = kMachineMode;
      return true;
    case csr::kUhartid:
      return read(csr::kMhartid, value);
    default:
      if (has_event_unit_ && inside(number, csr::kStackCheck, 3)) {
        value = state_.stack_check[number - csr::kStackCheck];
        return true;
      }
      return is_event_counter(number);  // other events are not counted: 0
  }
}

bool Csrs::write(unsigned number, std::uint32_t value) {
  switch (number) {
    case csr::kMstatus:
      state_.interrupts_on = (value & kMieBit) != 0;
      state_.interrupts_were_on = (value & kMpieBit) != 0;
      update_interrupts();
      return true;
    case csr::kMie:
      state_.mie = value & kInterruptLines;
      update_interrupts();
      return true;
    case csr::kMtvec:
      state_.mtvec = value & ~2U;
      return true;
    case csr::kMcountinhibit:
      set_count_inhibit(value & (kInhibitCycle | kInhibitInstret));
      return true;
    case csr::kMscratch:
      state_.mscratch = value;
      return true;
    case csr::kMepc:
      state_.mepc = value & ~1U;
      return true;
    case csr::kMcause:
      state_.mcause = value;
      return true;
    case csr::kMtval:
      state_.mtval = value;
      return true;
    case csr::kMcycle:
      write_counter(false, value, false);
      return true;
    case csr::kMcycleh:
      write_counter(false, value, true);
      return true;
    case csr::kMinstret:
      write_counter(true, value, false);
      return true;
    case csr::kMinstreth:
      write_counter(true, value, true);
      return true;
    case csr::kMisa:  // fixed
    case csr::kMip:   // lines of devices
      return true;
    default:
      return is_zero_register(number) || (timing_.has_xpulp() && write_ri5cy(number, value));
  }
}

bool Csrs::write_ri5cy(unsigned number, std::uint32_t value) {
  auto& loops = execution_.loops;
  if (inside(number, csr::kLoopStart0, 3) || inside(number, csr::kLoopStart1, 3)) {
    auto& loop = loops[number < csr::kLoopStart1 ? 0 : 1];
    const auto which = (number - csr::kLoopStart0) & 3U;
    (which == 0 ? loop.start : which == 1 ? loop.end : loop.count) = value;
    if (which == 1) cache_.end_block_at(value);
    return true;
  }
  switch (number) {
    case csr::kPccr:
    case csr::kPccr + 1:
      write_event_counter(number - csr::kPccr, value);
      return true;
    case csr::kPccrAll:
      for (unsigned counter = 0; counter < state_.pccr_base.size(); ++counter) write_event_counter(counter, value);
      return true;
    case csr::kPcer:
      set_event_enable(value & kEvents, state_.pcmr);
      return true;
    case csr::kPcmr:
      set_event_enable(state_.pcer, value & (kCountersOn | kCountersStop));
      return true;
    case csr::kUhartid:
      return true;
    default:
      if (has_event_unit_ && inside(number, csr::kStackCheck, 3)) {
        state_.stack_check[number - csr::kStackCheck] = value;
        return true;
      }
      return is_event_counter(number);
  }
}

bool Csrs::counts_event(unsigned counter) const {
  return (state_.pcmr & kCountersOn) != 0 && (state_.pcer >> counter & 1U) != 0;
}

/// As of the standard counters: while one counts, its base is the distance; otherwise it is the value.
std::uint32_t Csrs::read_event_counter(unsigned counter) const {
  const auto base = state_.pccr_base[counter];
  if (!counts_event(counter)) return static_cast<std::uint32_t>(base);
  const auto value = (counter == 0 ? execution_.counters.cycles : execution_.counters.instructions) - base;
  const bool full = value > 0xffffffffU && (state_.pcmr & kCountersStop) != 0;
  return full ? 0xffffffffU : static_cast<std::uint32_t>(value);
}

void Csrs::write_event_counter(unsigned counter, std::uint32_t value) {
  const auto next_count = (counter == 0 ? execution_.counters.cycles : execution_.counters.instructions) + 1;
  state_.pccr_base[counter] = counts_event(counter) ? next_count - value : value;
}

void Csrs::set_event_enable(std::uint32_t pcer, std::uint32_t pcmr) {
  const std::array<std::uint32_t, 2> values{read_event_counter(0), read_event_counter(1)};
  state_.pcer = pcer;
  state_.pcmr = pcmr;
  for (unsigned counter = 0; counter < values.size(); ++counter) write_event_counter(counter, values[counter]);
}

/// While a counter is inhibited its base holds its value; otherwise the value is the distance from the base.
std::uint64_t Csrs::read_counter(bool instret) const {
  const auto base = instret ? state_.instret_base : state_.cycle_base;
  const auto inhibit = instret ? kInhibitInstret : kInhibitCycle;
  if ((state_.mcountinhibit & inhibit) != 0) return base;
  return (instret ? execution_.counters.instructions : execution_.counters.cycles) - base;
}

void Csrs::write_counter(bool instret, std::uint32_t value, bool high) {
  auto wanted = read_counter(instret);
  wanted = high ? (wanted & 0xffffffffULL) | (std::uint64_t{value} << 32) : (wanted & ~0xffffffffULL) | value;
  auto& base = instret ? state_.instret_base : state_.cycle_base;
  const auto inhibit = instret ? kInhibitInstret : kInhibitCycle;
  // A write takes the place of its own instruction's increment: the next instruction reads back what was written.
  const auto count = instret ? execution_.counters.instructions + 1 : execution_.counters.cycles;
  base = (state_.mcountinhibit & inhibit) != 0 ? wanted : count - wanted;
}

void Csrs::set_count_inhibit(std::uint32_t value) {
  const auto cycle = read_counter(false);
  const auto instret = read_counter(true);
  state_.mcountinhibit = value;
  state_.cycle_base = (value & kInhibitCycle) != 0 ? cycle : execution_.counters.cycles - cycle;
  state_.instret_base = (value & kInhibitInstret) != 0 ? instret : execution_.counters.instructions - instret;
}

}  // namespace mebots::soc
