// SPDX-License-Identifier: Apache-2.0
//
// Control and status registers: those of machine mode that CV32E40P has. All others trap.
#include "hart/csr_numbers.hpp"
#include "hart/hart.hpp"

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

}  // namespace

const Instruction* Hart::csr_access(const Instruction* at) {
  auto& e = execution_;
  const auto number = static_cast<unsigned>(at->imm);
  const bool immediate = at->op >= Op::csrrwi;
  const auto operand = immediate ? at->rs1 : e.x[at->rs1];
  const bool replace = at->op == Op::csrrw || at->op == Op::csrrwi;
  const bool set = at->op == Op::csrrs || at->op == Op::csrrsi;
  // Set and clear with x0 (or 0) only read; replace into x0 only writes.
  const bool writes = replace || at->rs1 != 0;
  const bool read_only = (number >> 10) == 3;

  // Counters count what retired before this instruction.
  const auto saved = counters_;
  counters_.instructions += at->index;
  counters_.cycles += at->cycles_before + e.extra_cycles;
  std::uint32_t old = 0;
  bool good = read_csr(number, old) && !(writes && read_only);
  if (good && writes) good = write_csr(number, replace ? operand : set ? old | operand : old & ~operand);
  counters_ = saved;
  if (!good) {
    std::uint32_t word = 0;
    std::uint32_t address = 0;
    BlockCache::fetch(memory_, at->pc, word, address);
    return raise(at, cause::kIllegalInstruction, word);
  }
  e.x[at->rd] = old;
  return at + 1;
}

bool Hart::read_csr(unsigned number, std::uint32_t& value) const {
  value = 0;
  switch (number) {
    case csr::kMstatus:
      value = kMppMachine | (csrs_.interrupts_on ? kMieBit : 0U) | (csrs_.interrupts_were_on ? kMpieBit : 0U);
      return true;
    case csr::kMisa:
      value = kMisaValue;
      return true;
    case csr::kMie:
      value = csrs_.mie;
      return true;
    case csr::kMtvec:
      value = csrs_.mtvec;
      return true;
    case csr::kMcountinhibit:
      value = csrs_.mcountinhibit;
      return true;
    case csr::kMscratch:
      value = csrs_.mscratch;
      return true;
    case csr::kMepc:
      value = csrs_.mepc;
      return true;
    case csr::kMcause:
      value = csrs_.mcause;
      return true;
    case csr::kMtval:
      value = csrs_.mtval;
      return true;
    case csr::kMip:
      value = csrs_.mip;
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
      return is_zero_register(number);
  }
}

bool Hart::write_csr(unsigned number, std::uint32_t value) {
  switch (number) {
    case csr::kMstatus:
      csrs_.interrupts_on = (value & kMieBit) != 0;
      csrs_.interrupts_were_on = (value & kMpieBit) != 0;
      update_interrupts();
      return true;
    case csr::kMie:
      csrs_.mie = value & kInterruptLines;
      update_interrupts();
      return true;
    case csr::kMtvec:
      csrs_.mtvec = value & ~2U;
      return true;
    case csr::kMcountinhibit:
      set_count_inhibit(value & (kInhibitCycle | kInhibitInstret));
      return true;
    case csr::kMscratch:
      csrs_.mscratch = value;
      return true;
    case csr::kMepc:
      csrs_.mepc = value & ~1U;
      return true;
    case csr::kMcause:
      csrs_.mcause = value;
      return true;
    case csr::kMtval:
      csrs_.mtval = value;
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
      return is_zero_register(number);
  }
}

/// While a counter is inhibited its base holds its value; otherwise the value is the distance from the base.
std::uint64_t Hart::read_counter(bool instret) const {
  const auto base = instret ? csrs_.instret_base : csrs_.cycle_base;
  const auto inhibit = instret ? kInhibitInstret : kInhibitCycle;
  if ((csrs_.mcountinhibit & inhibit) != 0) return base;
  return (instret ? counters_.instructions : counters_.cycles) - base;
}

void Hart::write_counter(bool instret, std::uint32_t value, bool high) {
  auto wanted = read_counter(instret);
  wanted = high ? (wanted & 0xffffffffULL) | (std::uint64_t{value} << 32) : (wanted & ~0xffffffffULL) | value;
  auto& base = instret ? csrs_.instret_base : csrs_.cycle_base;
  const auto inhibit = instret ? kInhibitInstret : kInhibitCycle;
  // A write takes the place of its own instruction's increment: the next instruction reads back what was written.
  const auto count = instret ? counters_.instructions + 1 : counters_.cycles;
  base = (csrs_.mcountinhibit & inhibit) != 0 ? wanted : count - wanted;
}

void Hart::set_count_inhibit(std::uint32_t value) {
  const auto cycle = read_counter(false);
  const auto instret = read_counter(true);
  csrs_.mcountinhibit = value;
  csrs_.cycle_base = (value & kInhibitCycle) != 0 ? cycle : counters_.cycles - cycle;
  csrs_.instret_base = (value & kInhibitInstret) != 0 ? instret : counters_.instructions - instret;
}

}  // namespace mebots::soc
