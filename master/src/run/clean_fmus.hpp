// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/process/process_functions.hpp"
#include "mebots/run_state.hpp"
#include "model/resolved_system.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Finds effects that a run has on the next run in the same process. LibraryState describes these effects.
namespace mebots::master {

/// Returns the FMUs that are not clean, with the reasons (see LibraryState). All instances must have been freed.
std::vector<Leftover> leftovers_of(const ResolvedSystem& system);

/// Returns the name of the first FMU that computes with data outside of its instances' states, and the reason. Returns
/// nullopt if there is no such FMU.
std::optional<std::string> fmu_without_whole_state(const ResolvedSystem& system);
/// Throws InputError if an FMU computes with data outside of its instances' states. `what` names the call that requires
/// a complete state.
void require_whole_states(const ResolvedSystem& system, std::string_view what);

/// Protects process-wide data of the C library, such as the state of rand(), during a run. If FMUs of the run import
/// functions that change such data, the run starts with the data of a new process, or is rejected.
class ProcessUse {
 public:
  /// Resets the data that the FMUs of the run may change. Throws InputError that names the FMU and the function if an
  /// earlier run may have changed data that mebots cannot reset, or if another run is using the same data.
  explicit ProcessUse(const ResolvedSystem& system);
  ~ProcessUse();
  ProcessUse(const ProcessUse&) = delete;
  ProcessUse& operator=(const ProcessUse&) = delete;

 private:
  std::vector<std::string_view> used_;
};

}  // namespace mebots::master
