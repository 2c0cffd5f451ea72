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

/// What happens in a cluster beside the runs of its cores. The scheduler says when, in the order of ticks; the cluster
/// does it, and tells the scheduler what it changed (`set_alarm`, `cores_changed`).
class ClusterEvents {
 public:
  virtual ~ClusterEvents() = default;
  /// The registers do what was to happen by itself in this tick. Their next alarm lies behind it.
  virtual void alarm_rings(std::uint64_t tick) = 0;
  /// Every transfer of the DMA ends whose tick has come.
  virtual void transfers_end(std::uint64_t tick) = 0;
  /// A core came back from a run, neither at its limit nor for its turn. False: the run of the chip ends here, so none
  /// is given its turn any more.
  virtual bool core_stopped(ClusterCore& core, Stop stop) = 0;
};

/// The order in which the cores, registers and DMA of a cluster act: a round-robin scheduler, whose turns are a quantum
/// of ticks. The rule, and why it is so: schedule.md.
///
/// It knows ticks of the cluster's clock, and no other time. Each core has its own tick. The cluster asks for one
/// quantum after the other. Each starts where the one before said.
class ClusterScheduler {
 public:
  /// Ticks of a quantum in which nobody can find a bank taken.
  static constexpr std::uint64_t kLongQuantum = Banks::kLongestRun;
  /// More ticks than a core can be ahead of the start of the quantum that follows.
  static constexpr std::uint64_t kFarthestAhead = kLongQuantum + Banks::kLongestBlock;

  /// `way`: to the SoC, whose cycles the cores take in turns if the settings say so. All of it outlives the scheduler.
  ClusterScheduler(const ClusterSettings& settings, DecodedCode& code, Banks& way, ClusterDma& dma,
                   ClusterEvents& events);
  ClusterScheduler(const ClusterScheduler&) = delete;
  ClusterScheduler& operator=(const ClusterScheduler&) = delete;
  /// The next one in the order of their ids. It outlives the scheduler.
  void add(ClusterCore& core);

  /// How many cores are awake.
  unsigned awake() const { return awake_; }
  /// When the next quantum starts; kNoTick while all cores sleep and nothing is to happen by itself.
  std::uint64_t next_tick() const;
  /// Runs the quantum that starts at `start`, and ends before `until` at the latest. `undisturbed`: since the quantum
  /// before nothing came from outside. The answer is when the next one starts.
  std::uint64_t run_quantum(std::uint64_t start, std::uint64_t until, bool undisturbed);

  /// When something next happens in the registers by itself.
  void set_alarm(std::uint64_t tick) { alarm_ = tick; }
  /// A core may have begun, woken or fallen asleep, or another interrupt may be at it.
  void cores_changed();
  /// Every core begins its next run in the interpreter.
  void drop_resume_points();

  void visit(state::Visitor& v);

 private:
  // Between quanta.
  void share_banks();
  void move_banks(std::uint64_t tick);
  void next_in_front();
  // The cores that run without asking, one after the other.
  void line_up(std::uint64_t end);
  void queue_cores(std::uint64_t end);
  void rotate_queue();
  void reorder_queue();
  void run_queue(std::size_t place, std::uint64_t end);
  bool can_resume(const ClusterCore& core);
  std::size_t note_round(std::size_t place, const Hart::RoundEnd& round);
  void run_core(ClusterCore& core, std::uint64_t end);
  void note_stop(ClusterCore& core, Stop stop);
  // Those in step.
  std::uint64_t run_quantum_in_step(std::uint64_t start, std::uint64_t until);
  std::uint64_t keep_in_step();
  // All that has an order of its own.
  std::uint64_t finish_quantum(std::uint64_t end);
  void ring();
  std::uint64_t first_ready() const;
  ClusterCore& core_at(std::uint64_t ready);

  unsigned cores() const { return static_cast<unsigned>(cores_.size()); }

  const ClusterSettings& settings_;
  DecodedCode& code_;
  Banks& banks_;  // of L1
  Banks& way_;
  ClusterDma& dma_;
  ClusterEvents& events_;
  std::vector<ClusterCore*> cores_;
  unsigned awake_ = 0;               // of them
  std::uint64_t alarm_ = kNoTick;    // of the registers
  std::uint32_t first_core_ = 0;     // of the next quantum, when all are awake
  bool dma_first_ = false;           // in it, before the cores; else behind them
  bool sharing_banks_ = false;       // somebody can find a bank taken
  bool goes_on_ = true;              // cores are given their turns
  std::vector<ClusterCore*> queue_;  // of this quantum: who runs without asking, who comes first at a bank in front
  bool in_step_ = false;             // all who are awake came to the end of their last quantum in translated code
  std::uint64_t last_ready_ = 0;     // then: the tick of the core that is farthest ahead
  /// DecodedCode::version() when resume points were last dropped for it: they are good in this one only.
  std::uint64_t version_ = 0;
};

}  // namespace mebots::soc
