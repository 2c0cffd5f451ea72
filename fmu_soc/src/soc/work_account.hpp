// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "soc/decisions.hpp"
#include "soc/device_set.hpp"
#include "soc/hardware.hpp"
#include "soc/state_times.hpp"
#include "soc/timeline.hpp"

#include <string>
#include <string_view>

namespace mebots::soc {

/// Measures the work of a chip: its time in each state, the work of its cores, and its decisions.
class WorkAccount {
 public:
  /// `sender` is the name of the device that sends set-points; see Decisions.
  WorkAccount(const Hardware& hardware, const Timeline& timeline, const DeviceSet& devices, std::string sender)
      : hardware_(hardware), timeline_(timeline), devices_(devices), decisions_(std::move(sender)) {}

  /// Returns how long the chip was in each state up to now, including the whole duration of an instruction in progress.
  const StateTimes& state_times() const { return state_times_; }
  const Decisions& decisions() const { return decisions_; }

  /// Adds the time since the last call to the previous state of the chip, and determines the new state. The present
  /// time is `time`, or the fabric controller's time if the controller is awake and has advanced further.
  void pass(Picoseconds time);
  void picture_stored(const PictureTimes& times) { decisions_.picture_stored(times, work_at(times.stored)); }
  void setpoints_sent(std::string_view sender, Picoseconds now);
  /// Must be called at the end of each communication step. The set-points that were sent in the step are then visible
  /// outside the chip, which completes their decision.
  void publish(Picoseconds now) { decisions_.published(now); }
  /// Must be set to true for a program that runs without FMI. Its set-points are then visible as soon as they are sent.
  /// Not part of a saved state.
  void set_alone(bool alone) { alone_ = alone; }

  void visit(state::Visitor& v);

 private:
  ChipState chip_state() const;
  void note(Picoseconds time);
  Picoseconds controller_work(Picoseconds now) const;
  CoreWork work_at(Picoseconds now) const;

  const Hardware& hardware_;
  const Timeline& timeline_;
  const DeviceSet& devices_;
  StateTimes state_times_;
  Decisions decisions_;
  bool alone_ = false;
  /// Total time, up to work_noted_, in which the fabric controller was awake and the cluster did nothing.
  Picoseconds controller_work_ = 0;
  Picoseconds work_noted_ = 0;
  Picoseconds cluster_work_noted_ = 0;
  bool awake_noted_ = true;
};

}  // namespace mebots::soc
