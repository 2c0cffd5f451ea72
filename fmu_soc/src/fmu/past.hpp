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

/// Saved states of the chip, and the inputs of all steps, with which a debugger goes back in time. Only the chip goes
/// back. A replay gives it the same inputs, so that it reaches the present with the same bits. Meanwhile the other
/// models wait at the present.
struct Past {
  struct Step {
    std::uint64_t position = 0;  // of the history at the start of the step
    Picoseconds began = 0;       // the chip's time there
    std::int64_t end_ns = 0;
    StepInputs inputs;
  };

  debug::History history;
  std::vector<Step> steps;

  /// Adds the step that begins at the present position and time.
  void add(Picoseconds now, std::int64_t end_ns, const VariableFields& fields) {
    const auto* before = steps.empty() ? nullptr : &steps.back().inputs;
    steps.push_back({history.position(), now, end_ns, fields.inputs(before)});
  }

  /// Returns the step at whose start the chip is. Throws Error if there is none.
  std::size_t present(Picoseconds now) const {
    const auto found = std::ranges::find_if(
        steps, [&](const Step& step) { return step.position == history.position() && step.began == now; });
    if (found != steps.end()) return static_cast<std::size_t>(found - steps.begin());
    throw Error("gdb cannot go back to a time before a state that the co-simulation has restored");
  }

  /// Forgets all steps, because the co-simulation has restored another state.
  void forget() {
    history.cut();
    steps.clear();
  }
};

}  // namespace mebots::soc
