// SPDX-License-Identifier: Apache-2.0
//
// Effects of accesses to control and status registers: the column `meaning` of csrs.inc, and the functions that this
// column names.
#include "hart/csrs.hpp"

#include "hart/data_path.hpp"

#include "mebots/assert.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <type_traits>

namespace mebots::soc {
namespace {

constexpr std::uint32_t letter(char name) {
  return 1U << (name - 'A');
}
constexpr std::uint32_t kMisaValue = (1U << 30) | letter('I') | letter('M') | letter('C');  // RV32
constexpr std::uint32_t kMieBit = 1U << 3;
constexpr std::uint32_t kMpieBit = 1U << 7;
constexpr unsigned kMppShift = 11;
constexpr std::uint32_t kSomeDirty = 1U << 31;
constexpr std::uint32_t kModifiesPrivilege = 1U << 17;
constexpr std::uint32_t kWaitTraps = 1U << 21;
constexpr std::uint32_t kCounterEnables = 0xfffffffdU;  // without TM: U mode cannot read `time`
/// Interrupt lines of machine mode: software, timer, external, and 16 fast interrupts.
constexpr std::uint32_t kInterruptLines = 0xffff0000U | (1U << 11) | (1U << 7) | (1U << 3);
/// JEDEC number of the OpenHW Group, and architecture number of CV32E40P.
constexpr std::uint32_t kVendor = 0x602;
constexpr std::uint32_t kArchitecture = 4;
/// Offset of GAP8's vector for an ecall, after the vectors of 32 interrupts and of the reset.
constexpr std::uint32_t kGap8CallVector = 0x88;
constexpr std::uint32_t kCountersOn = 1U << 0;      // PCMR
constexpr std::uint32_t kCountersStop = 1U << 1;    // PCMR: counters stop at their highest value
constexpr std::uint32_t kEvents = (1U << 31) - 1U;  // PCER: all events

bool is_read_only(unsigned number) {
  return (number >> 10) == 3 && number != csr::kPcerUser && number != csr::kPcmrUser;
}

bool is_event_counter(unsigned number) {
  return number >= csr::kPccr && number <= csr::kPccrAll;
}

}  // namespace

/// The rows of csrs.inc, and for each kind of core a table from register numbers to rows.
struct Csrs::Rows {
  using Core = csr::Core;
  static constexpr std::size_t kCores = 3;  // every, ri5cy, gap8; optional registers are in all three tables
  static constexpr std::size_t kNumbers = 4096;

  struct Row;
  struct Meaning {
    std::uint32_t (*read)(const Csrs&, const Row&, unsigned index);
    void (*write)(Csrs&, const Row&, unsigned index, std::uint32_t value);  // null: a write has no effect
    bool keeps;  // true if the register keeps a word, whose value after reset is `reset`
    std::uint32_t reset;
    std::uint32_t written_bits = 0;  // see CsrForm
  };
  struct Row {
    unsigned number;
    unsigned count;
    Core core;
    Meaning meaning;
    std::string_view name;
    unsigned slot = 0;  // slot of the row's first register
  };

  static std::uint32_t kept(const Csrs& csrs, const Row& row, unsigned index) {
    return csrs.state_.words[row.slot + index];
  }

  template <std::uint32_t kMask = ~0U, auto kThen = nullptr>
  static constexpr Meaning word(std::uint32_t reset = 0) {
    return {kept,
            [](Csrs& csrs, const Row& row, unsigned index, std::uint32_t value) {
              csrs.state_.words[row.slot + index] = value & kMask;
              if constexpr (!std::is_null_pointer_v<decltype(kThen)>) (csrs.*kThen)();
            },
            true, reset, std::is_null_pointer_v<decltype(kThen)> ? kMask : 0};
  }
  static constexpr Meaning lines() { return {kept, nullptr, true, 0}; }
  template <std::uint32_t kValue>
  static constexpr Meaning constant() {
    return {[](const Csrs&, const Row&, unsigned) { return kValue; }, nullptr, false, 0};
  }
  template <auto kWrite>
  static constexpr auto writer() {
    if constexpr (std::is_null_pointer_v<decltype(kWrite)>) {
      return nullptr;
    } else {
      return [](Csrs& csrs, const Row&, [[maybe_unused]] unsigned index, std::uint32_t value) {
        if constexpr (std::is_invocable_v<decltype(kWrite), Csrs&, unsigned, std::uint32_t>) {
          (csrs.*kWrite)(index, value);
        } else {
          (csrs.*kWrite)(value);
        }
      };
    }
  }
  template <auto kRead, auto kWrite = nullptr>
  static constexpr Meaning of() {
    return {[](const Csrs& csrs, const Row&, [[maybe_unused]] unsigned index) {
              if constexpr (std::is_invocable_v<decltype(kRead), const Csrs&, unsigned>) {
                return (csrs.*kRead)(index);
              } else {
                return (csrs.*kRead)();
              }
            },
            writer<kWrite>(), false, 0};
  }
  template <auto kWrite>
  static constexpr Meaning of_word(std::uint32_t reset = 0) {
    return {kept, writer<kWrite>(), true, reset};
  }

  static const std::array<Row, csr::kPlaces.size()> kAll;
  /// For each kind of core and each register number: the index of the row plus 1, or 0 if there is no row.
  static const std::array<std::array<std::uint8_t, kNumbers>, kCores> kRowOf;
  static const Row* find(Core core, unsigned number);
  static const Row* find(const Csrs& csrs, unsigned number);
};

constexpr std::array<Csrs::Rows::Row, csr::kPlaces.size()> Csrs::Rows::kAll = [] {
  std::array<Row, csr::kPlaces.size()> rows{{
#define MEBOTS_CSR(constant, number, count, name, first, core, pace, ...) \
  {number, count, Core::core, __VA_ARGS__, name},
#include "hart/csrs.inc"
  }};
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].slot = csr::slots_before(i);
  return rows;
}();

/// If two rows contain the same register number, a row for GAP8 replaces a row for RI5CY, which replaces a row for
/// every core.
constexpr std::array<std::array<std::uint8_t, Csrs::Rows::kNumbers>, Csrs::Rows::kCores> Csrs::Rows::kRowOf = [] {
  std::array<std::array<std::uint8_t, kNumbers>, kCores> row_of{};
  for (std::size_t core = 0; core < kCores; ++core) {
    for (std::size_t rows_of = 0; rows_of <= core; ++rows_of) {
      for (std::size_t i = 0; i < kAll.size(); ++i) {
        const auto core_of_row = static_cast<std::size_t>(kAll[i].core);
        if ((core_of_row < kCores ? core_of_row : 0) != rows_of) continue;
        for (unsigned n = 0; n < kAll[i].count; ++n)
          row_of[core][kAll[i].number + n] = static_cast<std::uint8_t>(i + 1);
      }
    }
  }
  return row_of;
}();

/// Returns the row of this register, or null if no core of this kind has the register.
const Csrs::Rows::Row* Csrs::Rows::find(Core core, unsigned number) {
  if (number >= kNumbers) return nullptr;
  const auto row = kRowOf[static_cast<std::size_t>(core)][number];
  return row == 0 ? nullptr : &kAll[row - 1U];
}

/// Returns the row of this register, or null if this core does not have the register.
const Csrs::Rows::Row* Csrs::Rows::find(const Csrs& csrs, unsigned number) {
  const auto core = !csrs.timing_.has_xpulp() ? Core::every : csrs.has_gap8_interrupts_ ? Core::gap8 : Core::ri5cy;
  const auto* row = find(core, number);
  return row == nullptr || !csrs.has(row->core) ? nullptr : row;
}

CsrForm Csrs::form(const Timing& timing, unsigned number) {
  const auto* row = Rows::find(timing.has_xpulp() ? csr::Core::ri5cy : csr::Core::every, number);
  if (row == nullptr) return {};
  switch (number) {
    case csr::kMcycle:
    case csr::kCycle:
      return {CsrForm::Kind::cycle};
    case csr::kMcycleh:
    case csr::kCycleh:
      return {CsrForm::Kind::cycle_high};
    case csr::kMinstret:
    case csr::kInstret:
      return {CsrForm::Kind::instret};
    case csr::kMinstreth:
    case csr::kInstreth:
      return {CsrForm::Kind::instret_high};
    default:
      break;
  }
  const bool is_optional = row->core != csr::Core::every && row->core != csr::Core::ri5cy;
  if (is_optional || !row->meaning.keeps) return {};
  return {CsrForm::Kind::word, row->slot + number - row->number, row->meaning.written_bits};
}

/// Returns true if the core has the option that a row requires. Registers of F also need mstatus.FS.
bool Csrs::has(csr::Core core) const {
  switch (core) {
    case csr::Core::floats:
      return timing_.options.has_floats() && !execution_.float_off;
    case csr::Core::user:
      return timing_.options.has(Extension::user);
    case csr::Core::pmp:
      return pmp_.entries() != 0;
    default:
      return true;
  }
}

Csrs::Csrs(Execution& execution, BlockCache& blocks, const HartSettings& settings)
    : execution_(execution),
      blocks_(blocks),
      timing_(blocks.timing()),
      id_(settings.id),
      has_gap8_interrupts_(settings.has_gap8_interrupts),
      keeps_written_mtvec_(settings.keeps_written_mtvec),
      pmp_(timing_.pmp_entries) {
  execution.host.csrs = &state_;
  restart();
}

void Csrs::restart() {
  state_ = {};
  for (const auto& row : Rows::kAll) {
    MEBOTS_ASSERT(!row.meaning.keeps || row.slot + row.count <= state_.words.size());
    for (unsigned i = 0; i < row.count; ++i) state_.words[row.slot + i] = row.meaning.reset;
  }
  if (has_gap8_interrupts_) word<csr::kMie>() = ~0U;
  pmp_.restart();
  execution_.float_off = timing_.options.has(Extension::f);
  execution_.float_flags = 0;
  execution_.rounding = 0;
  execution_.reservation = {};
  update_guard();
  update_counting();
  if (has_gap8_interrupts_) state_.cause_kept_by_return = 0;
  set_handlers(word<csr::kMtvec>() = timing_.mtvec_after_reset());
  word<csr::kMcountinhibit>() = timing_.mcountinhibit_after_reset();
  const auto base = [this](std::uint32_t inhibit, std::uint64_t count) { return is_inhibited(inhibit) ? 0 : count; };
  state_.cycle_base = base(kInhibitCycle, execution_.counters.cycles);
  state_.instret_base = base(kInhibitInstret, execution_.counters.instructions);
  interrupt_ready_ = false;
}

void Csrs::set_interrupt(unsigned bit, bool level) {
  MEBOTS_ASSERT(bit < 32);
  const auto mask = 1U << bit;
  set_interrupts(level ? word<csr::kMip>() | mask : word<csr::kMip>() & ~mask);
}

void Csrs::set_interrupts(std::uint32_t lines) {
  word<csr::kMip>() = lines;
  update_interrupts();
}

void Csrs::update_interrupts() {
  // Code in U mode cannot disable the interrupts of machine mode.
  interrupt_ready_ = (state_.interrupts_on || state_.mode == Mode::user) && pending() != 0;
  if (interrupt_ready_) execution_.drop_resume_point();
}

void Csrs::enter_handler(std::uint32_t cause, std::uint32_t value) {
  word<csr::kMepc>() = execution_.pc;
  word<csr::kMcause>() = cause;
  set_mtval(value);
  state_.interrupts_were_on = state_.interrupts_on;
  state_.interrupts_on = false;
  state_.mode_before = state_.mode;
  set_mode(Mode::machine);
}

void Csrs::set_mode(Mode mode) {
  state_.mode = mode;
  update_interrupts();
  update_guard();
}

/// Makes the data path check each access if memory protection may deny an access in the core's mode, or in the mode
/// that its loads and stores use.
void Csrs::update_guard() {
  const bool was_guarded = guarded_;
  guarded_ = !pmp_.allows_all(state_.mode) || !pmp_.allows_all(data_mode());
  if (guarded_ != was_guarded && execution_.units != nullptr) execution_.units->data_path.guard(guarded_);
  execution_.drop_resume_point();
}

std::uint32_t Csrs::call_cause() const {
  return state_.mode == Mode::user ? cause::kUserEcall : cause::kMachineEcall;
}

std::uint32_t Csrs::leave_handler() {
  state_.interrupts_on = state_.interrupts_were_on;
  state_.interrupts_were_on = true;
  // GAP8's FreeRTOS tests bit 31 of mcause to find out whether it is in a handler, also after the handler. Therefore
  // mret clears mcause, as in GVSoC's models of GAP8. In the privileged specification, mret does not change mcause.
  word<csr::kMcause>() &= state_.cause_kept_by_return;
  const auto mode = state_.mode_before;
  if (timing_.options.has(Extension::user)) state_.mode_before = Mode::user;
  if (mode != Mode::machine) state_.modifies_privilege = false;
  set_mode(mode);
  return word<csr::kMepc>();
}

const Instruction* Csrs::access(const Instruction* at) {
  MEBOTS_ASSERT(is_csr(at->op));
  auto& e = execution_;
  const auto number = static_cast<unsigned>(at->imm);
  const bool immediate = traits_of(at->op).kind == OpKind::csr_immediate;
  const auto operand = immediate ? at->rs1 : e.x[at->rs1];
  const bool replace = at->op == Op::csrrw || at->op == Op::csrrwi;
  const bool set = at->op == Op::csrrs || at->op == Op::csrrsi;
  // If rs1 is x0 (or the immediate is 0), csrrs and csrrc only read. Event counters of RI5CY are an exception: such an
  // instruction also writes the value that it read, so the counter does not count this instruction.
  const bool writes = replace || at->rs1 != 0 || (timing_.has_xpulp() && is_event_counter(number));

  // Adds the previous instructions of the block to the counters, because the access may read a counter.
  const auto saved = e.counters;
  const bool counted = counts_events_;
  e.counters.instructions += at->index;
  e.counters.cycles = e.start_of(at);
  std::uint32_t old = 0;
  bool good = may_access(number) && read(number, old);
  record_stopped_counter(number);
  if (good && writes) good = write(number, replace ? operand : set ? old | operand : old & ~operand);
  e.counters = saved;
  if (!good) return e.raise(at, cause::kIllegalInstruction, blocks_.word_at(at->pc).value_or(0));
  e.x[at->rd] = old;
  if (counts_events_ != counted) return e.leave_after(at, Leave::counting);
  return blocks_.is_stale() ? e.leave_after(at, Leave::normal)
                            : at + 1;  // stale if the access has moved the end of a hardware loop
}

/// Returns true if the privilege mode allows an access to the register. Bits 9:8 of a register's number are the lowest
/// allowed mode. In U mode, mcounteren must also enable the counter.
bool Csrs::may_access(unsigned number) const {
  if (state_.mode == Mode::machine) return true;
  if ((number >> 8 & 3U) != 0) return false;
  const bool is_counter = (number >> 5 & ~4U) == 0xc00U >> 5;
  return !is_counter || (word<csr::kMcounteren>() >> (number & 31U) & 1U) != 0;
}

/// Records that the program read a counter that has not run since reset.
void Csrs::record_stopped_counter(unsigned number) {
  const bool cycles = number == csr::kMcycle || number == csr::kCycle;
  const bool instructions = number == csr::kMinstret || number == csr::kInstret;
  if (!cycles && !instructions) return;
  const auto reset = timing_.mcountinhibit_after_reset();
  if (reset != 0 && word<csr::kMcountinhibit>() == reset) remarks_.read_stopped_counter = number;
}

bool Csrs::read(unsigned number, std::uint32_t& value) const {
  MEBOTS_ASSERT(number < 0x1000, "twelve bits of the instruction");
  const auto* row = Rows::find(*this, number);
  value = row == nullptr ? 0 : row->meaning.read(*this, *row, number - row->number);
  return row != nullptr;
}

bool Csrs::write(unsigned number, std::uint32_t value) {
  const auto* row = Rows::find(*this, number);
  if (row == nullptr || is_read_only(number)) return false;
  if (row->meaning.write != nullptr) row->meaning.write(*this, *row, number - row->number, value);
  return true;
}

void Csrs::visit(state::Visitor& v) {
  for (const auto& row : Rows::kAll) {
    if (row.meaning.keeps) v(row.name, std::span(state_.words).subspan(row.slot, row.count));
  }
  v("interrupts_on", state_.interrupts_on);
  v("interrupts_were_on", state_.interrupts_were_on);
  v("handlers", state_.handlers);
  v("cycle_base", state_.cycle_base);
  v("instret_base", state_.instret_base);
  v("pccr_base", state_.pccr_base);
  v("interrupt_ready", interrupt_ready_);
  v("mode", state_.mode);
  v("mode_before", state_.mode_before);
  v("modifies_privilege", state_.modifies_privilege);
  v("wait_traps", state_.wait_traps);
  v("float_off", execution_.float_off);
  v("pmp", pmp_);
  if (!v.restores()) return;
  set_handlers(state_.handlers);
  update_guard();
  update_counting();
}

std::uint32_t Csrs::mstatus() const {
  const auto floats = timing_.options.has(Extension::f) && !execution_.float_off ? csr::kFloatsOn | kSomeDirty : 0U;
  return static_cast<std::uint32_t>(state_.mode_before) << kMppShift | (state_.interrupts_on ? kMieBit : 0U) |
         (state_.interrupts_were_on ? kMpieBit : 0U) | (state_.modifies_privilege ? kModifiesPrivilege : 0U) |
         (state_.wait_traps ? kWaitTraps : 0U) | floats;
}

void Csrs::set_mstatus(std::uint32_t value) {
  state_.interrupts_on = (value & kMieBit) != 0;
  state_.interrupts_were_on = (value & kMpieBit) != 0;
  if (timing_.options.has(Extension::f)) execution_.float_off = (value & csr::kFloatsOn) == 0;
  if (timing_.options.has(Extension::user)) {
    const auto before = value >> kMppShift & 3U;
    if (before == 0 || before == 3) state_.mode_before = static_cast<Mode>(before);
    state_.modifies_privilege = (value & kModifiesPrivilege) != 0;
    state_.wait_traps = (value & kWaitTraps) != 0;
    update_guard();
  }
  update_interrupts();
}

std::uint32_t Csrs::misa() const {
  const auto& options = timing_.options;
  const auto letters = [&](Extension extension, char name) { return options.has(extension) ? letter(name) : 0U; };
  const bool is_b = options.has(Extension::zba) && options.has(Extension::zbb) && options.has(Extension::zbs);
  return kMisaValue | letters(Extension::a, 'A') | letters(Extension::f, 'F') | letters(Extension::user, 'U') |
         (is_b ? letter('B') : 0U);
}

void Csrs::set_float_control(std::uint32_t value) {
  set_float_flags(value);
  set_float_rounding(value >> 5);
}

void Csrs::set_pmp_configurations(unsigned index, std::uint32_t value) {
  pmp_.set_configurations(index, value);
  update_guard();
}

void Csrs::set_pmp_address(unsigned entry, std::uint32_t value) {
  pmp_.set_address(entry, value);
  update_guard();
}

void Csrs::set_mtvec(std::uint32_t value) {
  word<csr::kMtvec>() = value & timing_.mtvec_mask();
  const bool moves = word<csr::kMtvec>() != (value & ~2U);
  set_handlers(keeps_written_mtvec_ ? value & ~2U : word<csr::kMtvec>());
  if (moves) remarks_.moved_mtvec = value;
}

void Csrs::set_handlers(std::uint32_t handlers) {
  state_.handlers = handlers;
  state_.call_handler = has_gap8_interrupts_ ? (handlers & ~0xffU) + kGap8CallVector : handlers & ~3U;
}

void Csrs::set_mtval(std::uint32_t value) {
  if (timing_.has_mtval()) word<csr::kMtval>() = value;
}

bool Csrs::counts_event(unsigned counter) const {
  MEBOTS_ASSERT(counter < state_.pccr_base.size());
  return (word<csr::kPcmr>() & kCountersOn) != 0 && (word<csr::kPcer>() >> counter & 1U) != 0;
}

std::uint64_t Csrs::event_count(unsigned counter) const {
  if (counter == 0) return execution_.counters.cycles;
  return counter == 1 ? execution_.counters.instructions : execution_.events[counter];
}

/// Event counters have a base, like the standard counters; see read_counter().
std::uint32_t Csrs::event_counter(unsigned counter) const {
  if (counter >= state_.pccr_base.size()) return 0;  // the core has no other events
  const auto base = state_.pccr_base[counter];
  if (!counts_event(counter)) return static_cast<std::uint32_t>(base);
  const auto value = event_count(counter) - base;
  const bool full = value > 0xffffffffU && (word<csr::kPcmr>() & kCountersStop) != 0;
  return full ? 0xffffffffU : static_cast<std::uint32_t>(value);
}

void Csrs::set_event_counter(unsigned counter, std::uint32_t value) {
  if (counter >= state_.pccr_base.size()) return;
  const auto next_count = event_count(counter) + (counter < 2 ? 1U : 0U);  // a CSR access counts as no other event
  state_.pccr_base[counter] = counts_event(counter) ? next_count - value : value;
}

void Csrs::set_event_counters(std::uint32_t value) {
  for (unsigned counter = 0; counter < state_.pccr_base.size(); ++counter) set_event_counter(counter, value);
}

void Csrs::set_counted_events(std::uint32_t value) {
  set_event_enable(value & kEvents, word<csr::kPcmr>());
}

void Csrs::set_count_mode(std::uint32_t value) {
  set_event_enable(word<csr::kPcer>(), value & (kCountersOn | kCountersStop));
}

void Csrs::set_event_enable(std::uint32_t pcer, std::uint32_t pcmr) {
  std::array<std::uint32_t, kEventCounters> values{};
  for (unsigned counter = 0; counter < values.size(); ++counter) values[counter] = event_counter(counter);
  word<csr::kPcer>() = pcer;
  word<csr::kPcmr>() = pcmr;
  for (unsigned counter = 0; counter < values.size(); ++counter) set_event_counter(counter, values[counter]);
  update_counting();
}

void Csrs::update_counting() {
  constexpr std::uint32_t kAccounted = (1U << kEventCounters) - 1U - 3U;
  counts_events_ = (word<csr::kPcmr>() & kCountersOn) != 0 && (word<csr::kPcer>() & kAccounted) != 0;
}

/// If the counter is inhibited, its value is its base. Otherwise its value is the core's count minus the base.
std::uint64_t Csrs::read_counter(bool instret) const {
  const auto base = instret ? state_.instret_base : state_.cycle_base;
  const auto inhibit = instret ? kInhibitInstret : kInhibitCycle;
  if (is_inhibited(inhibit)) return base;
  return (instret ? execution_.counters.instructions : execution_.counters.cycles) - base;
}

void Csrs::write_counter(bool instret, std::uint32_t value, bool high) {
  auto wanted = read_counter(instret);
  wanted = high ? (wanted & 0xffffffffULL) | (std::uint64_t{value} << 32) : (wanted & ~0xffffffffULL) | value;
  auto& base = instret ? state_.instret_base : state_.cycle_base;
  const auto inhibit = instret ? kInhibitInstret : kInhibitCycle;
  // The instruction that writes a counter does not also increment it. The next instruction therefore reads the written
  // value.
  const auto count = instret ? execution_.counters.instructions + 1 : execution_.counters.cycles;
  base = is_inhibited(inhibit) ? wanted : count - wanted;
}

void Csrs::set_count_inhibit(std::uint32_t value) {
  value &= timing_.mcountinhibit_mask();
  const auto cycle = read_counter(false);
  const auto instret = read_counter(true);
  word<csr::kMcountinhibit>() = value;
  state_.cycle_base = (value & kInhibitCycle) != 0 ? cycle : execution_.counters.cycles - cycle;
  state_.instret_base = (value & kInhibitInstret) != 0 ? instret : execution_.counters.instructions - instret;
}

}  // namespace mebots::soc
