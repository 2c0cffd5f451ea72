// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/block_cache.hpp"
#include "hart/csr_numbers.hpp"
#include "hart/execution.hpp"
#include "hart/observer.hpp"
#include "hart/pmp.hpp"
#include "hart/timing.hpp"
#include "mebots/state/visitor.hpp"

#include <array>
#include <cstdint>
#include <optional>

namespace mebots::soc {

/// CSR accesses whose effect differs from that on most other cores. The simulator prints messages about them.
struct CsrRemarks {
  /// Value that the program wrote to mtvec, if the core cleared some of its low bits.
  std::optional<std::uint32_t> moved_mtvec = {};
  std::optional<unsigned> read_stopped_counter =
      {};  // number of a counter that the program read although the counter has not run since reset
};

/// Values of the control and status registers that are not in Execution.
struct CsrState {
  /// Values of the registers that keep a word, indexed by csr::slot_of().
  std::array<std::uint32_t, csr::slots_before(csr::kPlaces.size())> words{};
  bool interrupts_on = false;       // mstatus.MIE
  bool interrupts_were_on = false;  // mstatus.MPIE
  Mode mode = Mode::machine;
  Mode mode_before = Mode::machine;  // mstatus.MPP
  bool modifies_privilege = false;   // mstatus.MPRV
  bool wait_traps = false;           // mstatus.TW
  std::uint64_t cycle_base = 0;      // mcycle = counter - base; if mcycle is inhibited, mcycle = base
  std::uint64_t instret_base = 0;
  std::uint32_t handlers = 0;                // address of the trap handlers: mtvec, or the value that was written to it
  std::uint32_t call_handler = 0;            // handler of an ecall; derived from `handlers`
  std::uint32_t cause_kept_by_return = ~0U;  // bits of mcause that mret keeps; constant
  EventCounts pccr_base{};                   // bases of RI5CY's event counters: see event_counter()
};

/// Describes how translated code accesses a CSR in machine mode.
struct CsrForm {
  enum class Kind : std::uint8_t {
    other,  // the interpreter performs the access
    word,   // the value is in CsrState::words
    cycle,
    cycle_high,
    instret,
    instret_high,
  };
  Kind kind = Kind::other;
  unsigned slot = 0;               // index in CsrState::words, if `kind` is `word`
  std::uint32_t written_bits = 0;  // a write changes only these bits of the word; 0 = the interpreter performs writes
};

/// The control and status registers of a core, from the table csrs.inc. Every core has CV32E40P's registers of machine
/// mode. A core with Xpulp also has RI5CY's registers. If it also has GAP8's interrupts, it has GAP8's registers as
/// well.
class Csrs {
 public:
  /// A core with GAP8's interrupts has the CSRs of the stack check. Programs can write and read them, but the model
  /// does not check the stack.
  Csrs(Execution& execution, BlockCache& blocks, const HartSettings& settings);

  /// Resets all registers. Counters that programs can read count from this time.
  void restart();
  bool has_gap8_interrupts() const { return has_gap8_interrupts_; }

  /// Reads or writes a CSR, without adding cycles. Returns false if the CSR does not exist or does not allow the
  /// access.
  bool read(unsigned number, std::uint32_t& value) const;
  bool write(unsigned number, std::uint32_t value);
  /// Executes a CSR instruction. Returns the next instruction of the block, or null if execution leaves the block.
  const Instruction* access(const Instruction* at);
  static CsrForm form(const Timing& timing, unsigned number);
  static constexpr std::uint32_t kInhibitCycle = 1U << 0;  // bits of mcountinhibit
  static constexpr std::uint32_t kInhibitInstret = 1U << 2;

  /// set_interrupt() sets the level of one interrupt line, which is a bit of mip. set_interrupts() sets all lines.
  void set_interrupt(unsigned bit, bool level);
  void set_interrupts(std::uint32_t lines);
  std::uint32_t pending() const { return word<csr::kMip>() & word<csr::kMie>(); }
  /// Returns true if an interrupt is pending and enabled, and mstatus allows the core to take it now.
  bool interrupt_ready() const { return interrupt_ready_; }
  bool interrupts_enabled() const {
    return (state_.interrupts_on || state_.mode == Mode::user) && word<csr::kMie>() != 0;
  }

  Mode mode() const { return state_.mode; }
  /// Returns the privilege mode that loads and stores use. If mstatus.MPRV is set, this is the mode in mstatus.MPP.
  Mode data_mode() const { return state_.modifies_privilege ? state_.mode_before : state_.mode; }
  /// Returns true if wfi raises an exception, because the core is in U mode and mstatus.TW is set.
  bool wait_traps() const { return state_.mode == Mode::user && state_.wait_traps; }
  const Pmp& pmp() const { return pmp_; }
  /// Returns true if the privilege mode may forbid an access or a fetch. Each access is then checked, and no code is
  /// translated.
  bool is_guarded() const { return guarded_; }
  /// Returns true if the program counts an event other than cycles and instructions. The cycles of each instruction
  /// must then be divided among their causes.
  bool counts_events() const { return counts_events_; }
  /// Returns the cause of the exception that an ecall raises in the present privilege mode.
  std::uint32_t call_cause() const;

  /// Returns the address of the trap handlers. Bit 0 is set if interrupts are vectored.
  std::uint32_t handlers() const { return state_.handlers; }
  /// Returns the address of the handler of an ecall.
  std::uint32_t call_handler() const { return state_.call_handler; }
  const CsrRemarks& remarks() const { return remarks_; }
  /// Enters a trap at the present pc: stores the pc, the cause and the value, and disables interrupts.
  void enter_handler(std::uint32_t cause, std::uint32_t value);
  Trapped last_trap() const { return {word<csr::kMepc>(), word<csr::kMcause>(), word<csr::kMtval>()}; }
  /// Executes mret. Returns the next pc.
  std::uint32_t leave_handler();

  void visit(state::Visitor& v);

 private:
  struct Rows;  // the rows of csrs.inc
  template <unsigned kNumber>
  std::uint32_t& word() {
    return state_.words[csr::slot_of(kNumber)];
  }
  template <unsigned kNumber>
  std::uint32_t word() const {
    return state_.words[csr::slot_of(kNumber)];
  }

  // Functions that the table csrs.inc names.
  std::uint32_t id() const { return id_; }
  std::uint32_t zero() const { return 0; }
  std::uint32_t misa() const;
  std::uint32_t privilege() const { return static_cast<std::uint32_t>(state_.mode); }
  std::uint32_t float_flags() const { return execution_.float_flags; }
  std::uint32_t float_rounding() const { return execution_.rounding; }
  std::uint32_t float_control() const { return float_rounding() << 5 | float_flags(); }
  void set_float_flags(std::uint32_t value) { execution_.float_flags = value & 31U; }
  void set_float_rounding(std::uint32_t value) { execution_.rounding = value & 7U; }
  void set_float_control(std::uint32_t value);
  std::uint32_t pmp_configurations(unsigned index) const { return pmp_.configurations(index); }
  void set_pmp_configurations(unsigned index, std::uint32_t value);
  std::uint32_t pmp_address(unsigned entry) const { return pmp_.address(entry); }
  void set_pmp_address(unsigned entry, std::uint32_t value);
  std::uint32_t mstatus() const;
  void set_mstatus(std::uint32_t value);
  void update_interrupts();
  std::uint32_t cycle() const { return static_cast<std::uint32_t>(read_counter(false)); }
  std::uint32_t cycle_high() const { return static_cast<std::uint32_t>(read_counter(false) >> 32); }
  std::uint32_t instret() const { return static_cast<std::uint32_t>(read_counter(true)); }
  std::uint32_t instret_high() const { return static_cast<std::uint32_t>(read_counter(true) >> 32); }
  void set_cycle(std::uint32_t value) { write_counter(false, value, false); }
  void set_cycle_high(std::uint32_t value) { write_counter(false, value, true); }
  void set_instret(std::uint32_t value) { write_counter(true, value, false); }
  void set_instret_high(std::uint32_t value) { write_counter(true, value, true); }
  void set_mtvec(std::uint32_t value);
  void set_handlers(std::uint32_t handlers);
  void set_mtval(std::uint32_t value);
  void set_count_inhibit(std::uint32_t value);
  std::uint32_t event_counter(unsigned counter) const;
  void set_event_counter(unsigned counter, std::uint32_t value);
  void set_event_counters(std::uint32_t value);
  std::uint32_t counted_events() const { return word<csr::kPcer>(); }
  std::uint32_t count_mode() const { return word<csr::kPcmr>(); }
  void set_counted_events(std::uint32_t value);
  void set_count_mode(std::uint32_t value);
  template <unsigned kLoop>
  std::uint32_t loop_start() const {
    return execution_.loops[kLoop].start;
  }
  template <unsigned kLoop>
  std::uint32_t loop_end() const {
    return execution_.loops[kLoop].end;
  }
  template <unsigned kLoop>
  std::uint32_t loop_count() const {
    return execution_.loops[kLoop].count;
  }
  template <unsigned kLoop>
  void set_loop_start(std::uint32_t value) {
    execution_.loops[kLoop].start = value;
  }
  template <unsigned kLoop>
  void set_loop_end(std::uint32_t value) {
    execution_.loops[kLoop].end = value;
    blocks_.end_block_at(value);
  }
  template <unsigned kLoop>
  void set_loop_count(std::uint32_t value) {
    execution_.loops[kLoop].count = value;
  }

  bool has(csr::Core core) const;
  bool may_access(unsigned number) const;
  void set_mode(Mode mode);
  void update_guard();
  bool is_inhibited(std::uint32_t bit) const { return (word<csr::kMcountinhibit>() & bit) != 0; }
  void record_stopped_counter(unsigned number);
  std::uint64_t read_counter(bool instret) const;
  void write_counter(bool instret, std::uint32_t value, bool high);
  bool counts_event(unsigned counter) const;
  std::uint64_t event_count(unsigned counter) const;
  void update_counting();
  void set_event_enable(std::uint32_t pcer, std::uint32_t pcmr);

  Execution& execution_;
  BlockCache& blocks_;
  Timing timing_;
  std::uint32_t id_;
  bool has_gap8_interrupts_;
  bool keeps_written_mtvec_;
  CsrRemarks remarks_;
  Pmp pmp_;
  CsrState state_;
  bool guarded_ = false;
  bool counts_events_ = false;
  bool interrupt_ready_ = false;
};

}  // namespace mebots::soc
