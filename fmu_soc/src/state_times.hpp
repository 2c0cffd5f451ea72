// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clock.hpp"
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

}  // namespace mebots::soc
