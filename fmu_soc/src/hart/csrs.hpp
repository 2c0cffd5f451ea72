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

/// CSR accesses whose effect differs from that on most other cores. Messages report these accesses.
struct CsrRemarks {
  std::optional<std::uint32_t> moved_mtvec = {};  // the value written, of which the core cleared low bits
  std::optional<unsigned> read_stopped_counter =
      {};  // number of a counter that was read although it has not run since reset
};

/// The values of the control and status registers that are not in Execution.
struct CsrState {
  std::array<std::uint32_t, csr::slots_before(csr::kPlaces.size())> words{};  // of the registers that have a word
  bool interrupts_on = false;                                                 // mstatus.MIE
  bool interrupts_were_on = false;                                            // mstatus.MPIE
  Mode mode = Mode::machine;
  Mode mode_before = Mode::machine;  // mstatus.MPP
  bool modifies_privilege = false;   // mstatus.MPRV
  bool wait_traps = false;           // mstatus.TW
  std::uint64_t cycle_base = 0;      // mcycle = counter - base; while inhibited, mcycle = base
  std::uint64_t instret_base = 0;
  std::uint32_t handlers = 0;  // entry of the handlers: mtvec, or the value written to it
  EventCounts pccr_base{};     // of RI5CY's event counters
};

/// Describes how translated code accesses a CSR in machine mode.
struct CsrForm {
  enum class Kind : std::uint8_t {
    other,  // by the interpreter
    word,   // of CsrState::words
    cycle,
    cycle_high,
    instret,
    instret_high,
  };
  Kind kind = Kind::other;
  unsigned slot = 0;               // of a word
  std::uint32_t written_bits = 0;  // a write changes only these bits of the word; 0: the interpreter writes
};

/// The control and status registers of a core, from the table csrs.inc. Every core has those of CV32E40P's machine
/// mode. A core with Xpulp also has RI5CY's. If such a core has GAP8's interrupts, it also has GAP8's. The registers
/// determine whether an interrupt is taken.
class Csrs {
 public:
  /// A core with GAP8's interrupts also has the CSRs of the stack check. In the model, programs can write and read
  /// these CSRs, but no stack is checked.
  Csrs(Execution& execution, BlockCache& blocks, const HartSettings& settings);

  /// Resets all registers. The program-visible counters count from this time.
  void restart();
  bool has_gap8_interrupts() const { return has_gap8_interrupts_; }

  /// Accesses a CSR like an instruction, but adds no cycles. Returns false if the CSR or this access does not exist.
  bool read(unsigned number, std::uint32_t& value) const;
  bool write(unsigned number, std::uint32_t value);
  /// Executes a CSR instruction.
  const Instruction* access(const Instruction* at);
  /// Returns how translated code accesses a CSR.
  static CsrForm form(const Timing& timing, unsigned number);
  static constexpr std::uint32_t kInhibitCycle = 1U << 0;  // bits of mcountinhibit
  static constexpr std::uint32_t kInhibitInstret = 1U << 2;

  /// set_interrupt() sets the level of one interrupt line (bit of mip); set_interrupts() sets all lines.
  void set_interrupt(unsigned bit, bool level);
  void set_interrupts(std::uint32_t lines);
  /// Returns the lines that are pending and enabled.
  std::uint32_t pending() const { return word<csr::kMip>() & word<csr::kMie>(); }
  /// True if an interrupt is pending and enabled, and mstatus lets the core take it now.
  bool interrupt_ready() const { return interrupt_ready_; }
  bool interrupts_enabled() const {
    return (state_.interrupts_on || state_.mode == Mode::user) && word<csr::kMie>() != 0;
  }

  /// The privilege mode of the next instruction.
  Mode mode() const { return state_.mode; }
  /// The privilege mode that loads and stores use. With mstatus.MPRV, this is the mode of the code before a trap.
  Mode data_mode() const { return state_.modifies_privilege ? state_.mode_before : state_.mode; }
  /// True if U mode must not execute wfi (mstatus.TW).
  bool wait_traps() const { return state_.mode == Mode::user && state_.wait_traps; }
  const Pmp& pmp() const { return pmp_; }
  /// True if the privilege mode may forbid an access or a fetch. In this case, each access is checked, and no code is
  /// translated.
  bool is_guarded() const { return guarded_; }
  /// True if the program counts an event other than cycles and instructions. In this case, each instruction must be
  /// accounted for separately.
  bool counts_events() const { return counts_events_; }
  /// Returns the cause of the exception that an ecall raises in the present mode.
  std::uint32_t call_cause() const;

  /// Returns the base address of the trap handlers. Bit 0 is set if interrupts are vectored.
  std::uint32_t handlers() const { return state_.handlers; }
  const CsrRemarks& remarks() const { return remarks_; }
  /// Enters a trap at the present pc: stores the cause of the trap, and disables interrupts.
  void enter_handler(std::uint32_t cause, std::uint32_t value);
  Trapped last_trap() const { return {word<csr::kMepc>(), word<csr::kMcause>(), word<csr::kMtval>()}; }
  /// Executes mret. Returns the next pc.
  std::uint32_t leave_handler();

  void visit(state::Visitor& v);

 private:
  struct Rows;  // the table csrs.inc, by number
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
