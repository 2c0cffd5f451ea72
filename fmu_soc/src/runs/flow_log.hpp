// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/execution.hpp"
#include "hart/instruction.hpp"
#include "runs/decoded_code.hpp"

#include <cstdint>
#include <memory>
#include <span>

namespace mebots::soc {

class ObservedRun;

/// Stores the steps that translated code records (see Flow), and reports them to the observer after the run.
class FlowLog {
 public:
  /// Maximum number of cycles of a run that records steps. The interpreter executes a block that may take more cycles.
  static constexpr std::uint64_t kLongestRun = std::uint64_t{1} << 14;

  FlowLog(Execution& execution, const DecodedCode& decoded) : execution_(execution), decoded_(decoded) {}

  /// Returns the number of cycles that a run may take without overflowing the log: `cycles` or less.
  std::uint64_t make_room(std::uint64_t cycles);
  /// Reports the steps that the last run has recorded to the observer, if there is one.
  void report(const ObservedRun& observed);

 private:
  void make_absolute(std::span<Flow> steps) const;

  Execution& execution_;
  const DecodedCode& decoded_;
  std::unique_ptr<Flow[]> steps_;  // buffer; allocated when it is first needed
};

}  // namespace mebots::soc
