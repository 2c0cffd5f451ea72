// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clock/clock.hpp"
#include "mebots/state/visitor.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace mebots::soc {

/// Names the states of a chip, in the order of the FMU's outputs. `cluster`: the cluster is on. `controller`: the
/// fabric controller is awake. `waiting`: a requested picture has not arrived. `asleep`: none of these conditions
/// holds. If several conditions hold, the first of them determines the state.
enum class ChipState : std::uint8_t { asleep, waiting, cluster, controller, off };

/// Measures the time that a chip spends in each state. Time without supply is not counted.
class StateTimes {
 public:
  static constexpr std::size_t kCounted = 4;

  /// Sets the state from `time` on. If `time` is before the last change, sets the state without counting time.
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

/// Is called at each time at which the state of a chip may have changed, except for changes by instructions alone.
/// These are the times of accesses to devices, of events of devices, of sleep, wake-up or end of a core, and the end of
/// the time that the caller requested. The times of successive calls never decrease.
class StateListener {
 public:
  StateListener() = default;
  StateListener(const StateListener&) = delete;
  StateListener& operator=(const StateListener&) = delete;
  virtual ~StateListener() = default;
  virtual void changed(Picoseconds time) = 0;
};

}  // namespace mebots::soc
