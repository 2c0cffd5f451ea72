// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clock/clock.hpp"
#include "mebots/state/visitor.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace mebots::soc {

/// What a chip does, one at a time, in the order of the FMU's outputs: `cluster` whenever that is on; else `controller`
/// while the fabric controller is awake; else `waiting` while a picture that was asked for is on its way; else
/// `asleep`.
enum class ChipState : std::uint8_t { asleep, waiting, cluster, controller, off };

/// How long it did what. Without a supply it does nothing, which is not counted.
class StateTimes {
 public:
  static constexpr std::size_t kCounted = 4;

  /// From `time` on it is in `state`. A time before the last one changes the state alone.
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

/// Receives each time at which something other than an instruction may have changed a chip: an access to a device, an
/// event of a device, sleep, wake-up or end of the core, or the end of the caller's span of time. Times never decrease.
class StateListener {
 public:
  StateListener() = default;
  StateListener(const StateListener&) = delete;
  StateListener& operator=(const StateListener&) = delete;
  virtual ~StateListener() = default;
  virtual void changed(Picoseconds time) = 0;
};

}  // namespace mebots::soc
