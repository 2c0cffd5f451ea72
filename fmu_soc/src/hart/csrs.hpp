// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/block_cache.hpp"
#include "hart/execution.hpp"
#include "hart/observer.hpp"
#include "hart/timing.hpp"
#include "mebots/state/visitor.hpp"

#include <array>
#include <cstdint>

namespace mebots::soc {

/// The control and status registers of a core: those of machine mode that CV32E40P has; with Xpulp also RI5CY's own.
/// All others are none. They own what decides whether an interrupt is let in.
class Csrs {
 public:
  Csrs(Execution& execution, BlockCache& cache, Timing timing)
      : execution_(execution), cache_(cache), timing_(timing) {}

  /// All 0, and the counters count from here on.
  void restart();
  void set_id(std::uint32_t id) { id_ = id; }
  void use_event_unit() { has_event_unit_ = true; }
  bool has_event_unit() const { return has_event_unit_; }

  /// As an instruction would, without its cycles; false = there is none, or not this way.
  bool read(unsigned number, std::uint32_t& value) const;
  bool write(unsigned number, std::uint32_t value);
  /// An instruction that does so.
  const Instruction* access(const Instruction* at);

  /// Level of an interrupt line (bit of mip), or of all.
  void set_interrupt(unsigned bit, bool level);
  void set_interrupts(std::uint32_t lines);
  /// Lines that are up and enabled.
  std::uint32_t pending() const { return state_.mip & state_.mie; }
  /// Whether one of these is let in (mstatus).
  bool interrupt_ready() const { return interrupt_ready_; }
  bool interrupts_enabled() const { return state_.interrupts_on && state_.mie != 0; }

  std::uint32_t mtvec() const { return state_.mtvec; }
  /// A trap at the pc: what happened is noted, and no interrupt is let in.
  void enter_handler(std::uint32_t cause, std::uint32_t value);
  Trapped last_trap() const { return {state_.mepc, state_.mcause, state_.mtval}; }
  /// mret: the pc to go on at.
  std::uint32_t leave_handler();

  void visit(state::Visitor& v) {
    state_.visit(v);
    v("interrupt_ready", interrupt_ready_);
  }

 private:
  struct State {
    std::uint32_t mie = 0;
    std::uint32_t mip = 0;
    std::uint32_t mtvec = 0;
    std::uint32_t mscratch = 0;
    std::uint32_t mepc = 0;
    std::uint32_t mcause = 0;
    std::uint32_t mtval = 0;
    std::uint32_t mcountinhibit = 0;
    bool interrupts_on = false;       // mstatus.MIE
    bool interrupts_were_on = false;  // mstatus.MPIE
    std::uint64_t cycle_base = 0;     // mcycle = counter - base; while inhibited, mcycle = base
    std::uint64_t instret_base = 0;
    std::uint32_t pcer = 0;  // RI5CY's event counters: which count
    std::uint32_t pcmr = 3;  // how they count
    std::array<std::uint64_t, 2> pccr_base{};
    std::array<std::uint32_t, 3> stack_check{};  // on or off, first address, end

    void visit(state::Visitor& v) {
      v("mie", mie);
      v("mip", mip);
      v("mtvec", mtvec);
      v("mscratch", mscratch);
      v("mepc", mepc);
      v("mcause", mcause);
      v("mtval", mtval);
      v("mcountinhibit", mcountinhibit);
      v("interrupts_on", interrupts_on);
      v("interrupts_were_on", interrupts_were_on);
      v("cycle_base", cycle_base);
      v("instret_base", instret_base);
      v("pcer", pcer);
      v("pcmr", pcmr);
      v("pccr_base", pccr_base);
      v("stack_check", stack_check);
    }
  };

  void update_interrupts();
  std::uint64_t read_counter(bool instret) const;
  void write_counter(bool instret, std::uint32_t value, bool high);
  void set_count_inhibit(std::uint32_t value);
  bool read_ri5cy(unsigned number, std::uint32_t& value) const;
  bool write_ri5cy(unsigned number, std::uint32_t value);
  bool counts_event(unsigned counter) const;
  std::uint32_t read_event_counter(unsigned counter) const;
  void write_event_counter(unsigned counter, std::uint32_t value);
  void set_event_enable(std::uint32_t pcer, std::uint32_t pcmr);

  Execution& execution_;
  BlockCache& cache_;
  Timing timing_;
  State state_;
  std::uint32_t id_ = 0;
  bool has_event_unit_ = false;
  bool interrupt_ready_ = false;
};

}  // namespace mebots::soc
