// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/execution.hpp"
#include "hart/flow.hpp"
#include "runs/decoded_code.hpp"

#include <cstdint>
#include <memory>
#include <span>

namespace mebots::soc {

class ObservedRun;

/// Steps between functions that translated code notes in a run, for an observer who hears of them behind it.
class FlowNotes {
 public:
  /// Cycles that translated code may stay when it notes steps: more than any block takes.
  static constexpr std::uint64_t kLongestRun = std::uint64_t{1} << 14;

  FlowNotes(Execution& execution, const DecodedCode& decoded) : execution_(execution), decoded_(decoded) {}

  /// How far a run may go so that there is room for what it notes.
  std::uint64_t make_room(std::uint64_t cycles);
  /// Tells the observer, if there is one, what the run that has just ended has noted.
  void tell(const ObservedRun& observed);

 private:
  void make_absolute(std::span<Flow> steps) const;

  Execution& execution_;
  const DecodedCode& decoded_;
  std::unique_ptr<Flow[]> steps_;  // made when first wanted
};

}  // namespace mebots::soc
