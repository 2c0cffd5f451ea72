// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clock/clock.hpp"
#include "mebots/state/visitor.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace mebots::soc {

/// States of a chip. `cluster`: the cluster is on. `controller`: the fabric controller is awake. `waiting`: a requested
/// picture has not arrived. `asleep`: none of these conditions holds. If several conditions hold, the first in this
/// list determines the state. The enumerators are in the order of the FMU's outputs.
enum class ChipState : std::uint8_t { asleep, waiting, cluster, controller, off };

/// Measures how long a chip is in each state. Does not count time without supply.
class StateTimes {
 public:
  static constexpr std::size_t kCounted = 4;

  /// Sets the state from `time` on, and counts the time in the previous state. If `time` is before the last change,
  /// counts no time.
  void pass(Picoseconds time, ChipState state) {
    if (time > since_) {
      if (state_ != ChipState::off) total_[static_cast<std::size_t>(state_)] += time - since_;
      since_ = time;
    }
    state_ = state;
  }
  Picoseconds total(std::size_t state) const { return total_[state]; }

  void visit(state::Visitor& v) {
    v("state", state_);
    v("since", since_);
    v("total", total_);
  }

 private:
  ChipState state_ = ChipState::asleep;
  Picoseconds since_ = 0;
  std::array<Picoseconds, kCounted> total_{};
};

/// Called whenever the state of a chip may have changed, except by instructions alone: at accesses to devices, at
/// events of devices, when a core sleeps, wakes or ends, and when Soc::advance() or run_cycles() starts or returns. The
/// times of successive calls never decrease.
class StateListener {
 public:
  StateListener() = default;
  StateListener(const StateListener&) = delete;
  StateListener& operator=(const StateListener&) = delete;
  virtual ~StateListener() = default;
  virtual void changed(Picoseconds time) = 0;
};

}  // namespace mebots::soc
