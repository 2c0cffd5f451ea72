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

/// Handles the events of a cluster other than runs of its cores. The scheduler calls these functions in the order of
/// ticks. They report their effects by calls of set_alarm() and cores_changed().
class ClusterEvents {
 public:
  virtual ~ClusterEvents() = default;
  /// Handles the event of the cluster's registers in this tick. Must set the alarm to a later tick.
  virtual void alarm_rings(std::uint64_t tick) = 0;
  /// Ends all DMA transfers whose last tick is reached.
  virtual void transfers_end(std::uint64_t tick) = 0;
  /// Called if a core stopped for another reason than its limit or a wait for its turn. If the function returns false,
  /// the cores that are still queued in this quantum run, and then the run of the chip ends.
  virtual bool core_stopped(ClusterCore& core, Stop stop) = 0;
};

/// Determines the order in which the cores, registers and DMA of a cluster act: each core in turn runs a quantum of
/// ticks (round robin). schedule.md explains the rule.
///
/// Times are ticks of the cluster's clock.
class ClusterScheduler {
 public:
  /// Length of a quantum [ticks] if no bank conflicts are possible.
  static constexpr std::uint64_t kLongQuantum = Banks::kLongestRun;
  /// Largest number of ticks by which a core can be ahead of the start of the next quantum.
  static constexpr std::uint64_t kFarthestAhead = kLongQuantum + Banks::kLongestBlock;

  /// `way` is the port to the SoC, which the cores may share (ClusterSettings::shares_soc_port). All references must
  /// outlive the scheduler.
  ClusterScheduler(const ClusterSettings& settings, DecodedCode& code, Banks& way, ClusterDma& dma,
                   ClusterEvents& events);
  ClusterScheduler(const ClusterScheduler&) = delete;
  ClusterScheduler& operator=(const ClusterScheduler&) = delete;
  /// Adds a core. Cores must be added in the order of their ids, and must outlive the scheduler.
  void add(ClusterCore& core);

  unsigned awake() const { return awake_; }
  /// Returns the tick in which the next quantum starts, or kNoTick if all cores sleep and no event is due.
  std::uint64_t next_tick() const;
  /// Runs a quantum from `start` to at most `until`, and returns the start of the next quantum. `undisturbed` must only
  /// be true if `start` is the result of the previous call, and no access from outside the cluster has occurred since
  /// then. Otherwise `start` must be the result of next_tick().
  std::uint64_t run_quantum(std::uint64_t start, std::uint64_t until, bool undisturbed);

  /// Returns true if the running core need not wait for permission to access shared devices in this tick: all other
  /// cores sleep, the quantum has not ended, and no event is due up to this tick. Must be called in the order of the
  /// core's accesses.
  bool permits_at_once(std::uint64_t tick);

  /// Sets the tick of the next event of the cluster's registers.
  void set_alarm(std::uint64_t tick) { alarm_ = tick; }
  /// Must be called if a core may have started, woken or fallen asleep, or if its interrupts may have changed.
  void cores_changed();
  /// Drops the resume points of all cores, so that their next runs start in the interpreter.
  void drop_resume_points();

  void visit(state::Visitor& v);

 private:
  void share_banks();
  void move_banks(std::uint64_t tick);
  void next_in_front();
  void line_up(std::uint64_t end);
  void queue_cores(std::uint64_t end);
  void rotate_queue();
  void reorder_queue();
  void run_queue(std::size_t place, std::uint64_t end);
  bool can_resume(const ClusterCore& core);
  std::size_t note_round(std::size_t place, const Hart::RoundEnd& round);
  void run_core(ClusterCore& core, std::uint64_t end);
  void note_stop(ClusterCore& core, Stop stop);
  std::uint64_t run_quantum_in_step(std::uint64_t start, std::uint64_t until);
  std::uint64_t keep_in_step();
  std::uint64_t finish_quantum(std::uint64_t end);
  void ring();
  std::uint64_t first_ready() const;
  ClusterCore& core_at(std::uint64_t ready);

  unsigned cores() const { return static_cast<unsigned>(cores_.size()); }

  const ClusterSettings& settings_;
  DecodedCode& code_;
  Banks& banks_;  // banks of L1
  Banks& soc_port_;
  ClusterDma& dma_;
  ClusterEvents& events_;
  std::vector<ClusterCore*> cores_;
  unsigned awake_ = 0;
  std::uint64_t alarm_ = kNoTick;  // next event of the registers
  std::uint32_t first_core_ = 0;   // first core of the next quantum if all cores are awake
  bool dma_first_ = false;         // true if the DMA claims banks before the cores in the next quantum
  bool sharing_banks_ = false;     // true if bank conflicts are possible
  std::uint64_t end_ = 0;          // last tick of this quantum, plus 1
  bool goes_on_ = true;            // set to false to end the run
  /// Cores that do not wait for permission to access a shared device at the start of this quantum, in the order in
  /// which they run.
  std::vector<ClusterCore*> queue_;
  bool in_step_ = false;          // true if all awake cores have ended the last quantum in translated code
  std::uint64_t last_ready_ = 0;  // if in_step_: tick of the core that is farthest ahead
  /// Value of DecodedCode::version() for which the resume points are valid.
  std::uint64_t version_ = 0;
};

}  // namespace mebots::soc
