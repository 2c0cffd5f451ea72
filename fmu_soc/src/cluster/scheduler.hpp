// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cluster/core.hpp"
#include "cluster/settings.hpp"
#include "memory/banks.hpp"
#include "runs/decoded_code.hpp"
#include "runs/hart.hpp"

#include "mebots/state/visitor.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mebots::soc {

/// Events of a cluster other than runs of its cores. The scheduler calls these functions in the order of ticks. The
/// cluster reports the effects to the scheduler (`set_alarm`, `cores_changed`).
class ClusterEvents {
 public:
  virtual ~ClusterEvents() = default;
  /// Runs the event of the registers in this tick. The registers' next alarm must be at a later tick.
  virtual void alarm_rings(std::uint64_t tick) = 0;
  /// Ends every DMA transfer whose end tick is reached.
  virtual void transfers_end(std::uint64_t tick) = 0;
  /// Called if a core stopped before its limit, for another reason than the order of cores. The function returns false
  /// to end the run of the chip. In this case, no core runs again.
  virtual bool core_stopped(ClusterCore& core, Stop stop) = 0;
};

/// The order in which the cores, registers and DMA of a cluster act: a round-robin scheduler with turns of a quantum of
/// ticks. schedule.md states the rule and its reasons.
///
/// The scheduler only uses ticks of the cluster's clock. Each core has its own tick. Each quantum starts at the tick
/// that the previous quantum returned.
class ClusterScheduler {
 public:
  /// Ticks of a quantum without conflicts at the banks.
  static constexpr std::uint64_t kLongQuantum = Banks::kLongestRun;
  /// Upper bound of the ticks by which a core can be ahead of the start of the next quantum.
  static constexpr std::uint64_t kFarthestAhead = kLongQuantum + Banks::kLongestBlock;

  /// `way` is the port to the SoC. The settings determine whether cores share this port. All references must outlive
  /// the scheduler.
  ClusterScheduler(const ClusterSettings& settings, DecodedCode& code, Banks& way, ClusterDma& dma,
                   ClusterEvents& events);
  ClusterScheduler(const ClusterScheduler&) = delete;
  ClusterScheduler& operator=(const ClusterScheduler&) = delete;
  /// Adds a core. Cores must be added in the order of their ids, and outlive the scheduler.
  void add(ClusterCore& core);

  /// Returns the number of cores that are awake.
  unsigned awake() const { return awake_; }
  /// Returns the start of the next quantum; kNoTick while all cores sleep and no event is due.
  std::uint64_t next_tick() const;
  /// Runs a quantum from `start` to at most `until`. `undisturbed` is true if no access from outside the cluster has
  /// occurred since the previous quantum. Returns the start of the next quantum.
  std::uint64_t run_quantum(std::uint64_t start, std::uint64_t until, bool undisturbed);

  /// Sets the tick of the registers' next event.
  void set_alarm(std::uint64_t tick) { alarm_ = tick; }
  /// Called if a core may have started, woken or fallen asleep, or if its interrupts may have changed.
  void cores_changed();
  /// Makes every core start its next run in the interpreter.
  void drop_resume_points();

  void visit(state::Visitor& v);

 private:
  // Between quanta.
  void share_banks();
  void move_banks(std::uint64_t tick);
  void next_in_front();
  // Functions for the queue of the cores that run without permission.
  void line_up(std::uint64_t end);
  void queue_cores(std::uint64_t end);
  void rotate_queue();
  void reorder_queue();
  void run_queue(std::size_t place, std::uint64_t end);
  bool can_resume(const ClusterCore& core);
  std::size_t note_round(std::size_t place, const Hart::RoundEnd& round);
  void run_core(ClusterCore& core, std::uint64_t end);
  void note_stop(ClusterCore& core, Stop stop);
  // Functions for a quantum after all awake cores ended the previous quantum in translated code.
  std::uint64_t run_quantum_in_step(std::uint64_t start, std::uint64_t until);
  std::uint64_t keep_in_step();
  // Functions for events in the order of their ticks.
  std::uint64_t finish_quantum(std::uint64_t end);
  void ring();
  std::uint64_t first_ready() const;
  ClusterCore& core_at(std::uint64_t ready);

  unsigned cores() const { return static_cast<unsigned>(cores_.size()); }

  const ClusterSettings& settings_;
  DecodedCode& code_;
  Banks& banks_;  // of L1
  Banks& soc_port_;
  ClusterDma& dma_;
  ClusterEvents& events_;
  std::vector<ClusterCore*> cores_;
  unsigned awake_ = 0;               // number of awake cores
  std::uint64_t alarm_ = kNoTick;    // next event of the registers
  std::uint32_t first_core_ = 0;     // first core of the next quantum if all are awake
  bool dma_first_ = false;           // true if the DMA claims banks before the cores in that quantum
  bool sharing_banks_ = false;       // conflicts at the banks are possible
  bool goes_on_ = true;              // false after the run was ended
  std::vector<ClusterCore*> queue_;  // cores of this quantum that run without permission, in their order
  bool in_step_ = false;             // all awake cores ended their last quantum in translated code
  std::uint64_t last_ready_ = 0;     // if in step: tick of the core that is farthest ahead
  /// DecodedCode::version() for which the resume points are valid.
  std::uint64_t version_ = 0;
};

}  // namespace mebots::soc
