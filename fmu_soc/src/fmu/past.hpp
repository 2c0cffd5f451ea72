// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "debug/history.hpp"
#include "fmu/variable_fields.hpp"
#include "mebots/error.hpp"
#include "mebots/soc/time.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace mebots::soc {

/// Stores what a debugger needs to return to earlier steps of a mission: states of the chip, and the inputs of all
/// steps. Only the chip returns; the other models of the mission wait. A replay with the same inputs ends in exactly
/// the present state.
struct Past {
  struct Step {
    std::uint64_t position = 0;  // position in the history at the start of the step
    Picoseconds began = 0;       // time of the chip at the start of the step
    std::int64_t end_ns = 0;
    StepInputs inputs;
  };

  debug::History history;
  std::vector<Step> steps;

  /// Records a new step of the mission, which begins at the present position and time.
  void begin_step(Picoseconds now, std::int64_t end_ns, const VariableFields& fields) {
    const auto* before = steps.empty() ? nullptr : &steps.back().inputs;
    steps.push_back({history.position(), now, end_ns, fields.inputs(before)});
  }

  /// Records that a step of the mission begins again. If gdb has changed the chip, the step may begin at another
  /// position of the history than before.
  void repeat_step(std::size_t step, Picoseconds now) {
    steps[step].position = history.position();
    steps[step].began = now;
  }

  /// Returns the index of the step that begins at the chip's present position. Throws Error if no step begins there.
  std::size_t current_step(Picoseconds now) const {
    const auto found = std::ranges::find_if(
        steps, [&](const Step& step) { return step.position == history.position() && step.began == now; });
    if (found != steps.end()) return static_cast<std::size_t>(found - steps.begin());
    throw Error("gdb cannot go back to a state at which no recorded step of the mission begins");
  }

  /// Deletes all recorded steps and saved states. Must be called after the co-simulation has restored another state of
  /// the chip.
  void clear() {
    history.clear();
    steps.clear();
  }
};

}  // namespace mebots::soc
