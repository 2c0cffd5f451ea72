// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/process/process_functions.hpp"
#include "mebots/run_state.hpp"
#include "model/resolved_system.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Effects of a run on the next one in the same process, see LibraryState.
namespace mebots::master {

/// Lists the FMUs that are not clean. All instances must have been freed.
std::vector<Leftover> leftovers_of(const ResolvedSystem& system);

/// The first FMU whose state does not hold everything that it computes with, and why. If all states are whole,
/// returns nothing.
std::optional<std::string> fmu_without_whole_state(const ResolvedSystem& system);
/// Throws InputError that names such an FMU; `what` is the call that needs a state.
void require_whole_states(const ResolvedSystem& system, std::string_view what);

/// The use that one run makes of what the C library keeps for the whole process, such as the generator of rand(). A run
/// whose FMUs import the functions begins with all of it as in a fresh process, or is refused.
class ProcessUse {
 public:
  /// Throws InputError that names the FMU and the function if an earlier run may have changed what mebots cannot set
  /// back, or if another run uses the same at the moment.
  explicit ProcessUse(const ResolvedSystem& system);
  ~ProcessUse();
  ProcessUse(const ProcessUse&) = delete;
  ProcessUse& operator=(const ProcessUse&) = delete;

 private:
  std::vector<std::string_view> used_;
};

}  // namespace mebots::master
