// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/board_device.hpp"
#include "mebots/soc/time.hpp"
#include "mebots/state/visitor.hpp"

#include <string_view>

namespace mebots::soc {

/// Measures the active time of a device that has the states `idle` and `active`, and computes its energy.
class ActiveTime {
 public:
  /// Throws Error if the board's entry lacks one of the two states.
  explicit ActiveTime(const BoardDevice& entry)
      : idle_w_(entry.state("idle").current_a * entry.supply_voltage_v),
        active_w_(entry.state("active").current_a * entry.supply_voltage_v) {}

  bool active() const { return active_; }
  std::string_view state_name() const { return active_ ? "active" : "idle"; }

  /// Changes the state at `now`. Returns false if the device was already in this state.
  bool set(bool active, Picoseconds now) {
    if (active == active_) return false;
    if (active_) total_ += now - since_;
    since_ = now;
    active_ = active;
    return true;
  }

  double energy_j(Picoseconds now) const {
    const auto active = total_ + (active_ ? now - since_ : 0);
    return (static_cast<double>(active) * active_w_ + static_cast<double>(now - active) * idle_w_) / kPsPerS;
  }

  void visit(state::Visitor& v) {
    v("active", active_);
    v("since", since_);
    v("total", total_);
  }

 private:
  double idle_w_;
  double active_w_;
  bool active_ = false;
  Picoseconds since_ = 0;  // time of the last change of `active_`
  Picoseconds total_ = 0;  // active time before `since_`
};

}  // namespace mebots::soc
