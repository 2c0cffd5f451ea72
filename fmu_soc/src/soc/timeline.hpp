// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clock/clock.hpp"
#include "cluster/cluster.hpp"
#include "mebots/state/visitor.hpp"
#include "runs/hart.hpp"

#include <algorithm>
#include <cstdint>

namespace mebots::soc {

/// The reason why a chip has stopped.
enum class End : std::uint8_t { none, exited, faulted, powered_off, host, stopped };

/// The time of a chip: the clock of the fabric controller, its sleep, and the end of the program.
class Timeline {
 public:
  explicit Timeline(const Hart& hart) : hart_(hart) {}

  Clock& clock() { return clock_; }
  const Clock& clock() const { return clock_; }
  Picoseconds now() const { return now_; }
  void reach(Picoseconds time) { now_ = time; }
  /// Returns the start time of the fabric controller's next instruction or of its sleep.
  Picoseconds core_time() const { return clock_.time_of(hart_.counters().cycles); }

  End end() const { return end_; }
  bool running() const { return end_ == End::none; }
  /// Returns true while the fabric controller waits for an interrupt, and after the end of the program.
  bool asleep() const { return asleep_; }
  Picoseconds asleep_since() const { return asleep_since_; }
  bool retained() const { return retained_; }
  /// Returns the cluster core that has ended the program, or kFabricControllerCore.
  int ended_by() const { return ended_by_; }
  void set_ended_by(unsigned core) { ended_by_ = static_cast<std::int32_t>(core); }

  void sleep(bool retained);
  /// Ends the sleep. The next instruction starts at the first tick at or after `time`.
  void wake(Picoseconds time);
  void end_retention(Picoseconds time);
  /// Ends the program at `time`, or at the fabric controller's time if that is later.
  void finish(End why, Picoseconds time);
  /// Switches off the chip's supply at the present time.
  void power_off();

  Picoseconds slept_at(Picoseconds now) const {
    return slept_ + (asleep_ && now > asleep_since_ ? now - asleep_since_ : 0);
  }
  Picoseconds retention_at(Picoseconds now) const {
    return retention_ + (retained_ && now > asleep_since_ ? now - asleep_since_ : 0);
  }
  /// Returns `time`, or the time at which the supply was switched off if that is earlier.
  Picoseconds supplied_until(Picoseconds time) const {
    return end_ == End::powered_off ? std::min(time, end_time_) : time;
  }
  /// Returns the time that a run without a time limit has reached: the end of the program or, if the program still
  /// runs, the latest time of all cores.
  Picoseconds reached(const Cluster* cluster) const;
  /// Returns the time of the cluster's next activity, or kNever if it has nothing to do.
  Picoseconds next_of(const Cluster* cluster) const {
    return cluster != nullptr && running() ? cluster->next() : kNever;
  }

  void visit(state::Visitor& v);
  /// Throws Error if a restored state names a core that the chip does not have.
  void check(const Cluster* cluster) const;

 private:
  const Hart& hart_;
  Clock clock_;
  Picoseconds now_ = 0;
  End end_ = End::none;
  std::int32_t ended_by_ = kFabricControllerCore;
  Picoseconds end_time_ = 0;
  bool asleep_ = false;
  Picoseconds asleep_since_ = 0;
  Picoseconds slept_ = 0;  // total time asleep up to the last wake-up
  bool retained_ = false;
  Picoseconds retention_ = 0;  // total time in retention sleep up to the last wake-up
};

}  // namespace mebots::soc
