// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/process/process_functions.hpp"
#include "mebots/run_state.hpp"
#include "model/resolved_system.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Finds effects of a run on the next run in the same process. LibraryState defines these effects.
namespace mebots::master {

/// Returns the FMUs that are not clean (see LibraryState). All instances must have been freed.
std::vector<Leftover> leftovers_of(const ResolvedSystem& system);

/// Returns the name of the first FMU that computes with data outside of its instances' states, and the reason. Empty if
/// there is none.
std::optional<std::string> fmu_without_whole_state(const ResolvedSystem& system);
/// Throws InputError if an FMU computes with data outside of its instances' states. `what` names the call that needs a
/// complete state.
void require_whole_states(const ResolvedSystem& system, std::string_view what);

/// Guards process-wide data of the C library, such as the state of rand(), during a run. If the FMUs of the run import
/// functions that use such data, the run starts with the data of a new process, or is rejected.
class ProcessUse {
 public:
  /// Throws InputError with the FMU and the function in two cases. In the first case, an earlier run may have changed
  /// data that mebots cannot reset. In the second case, another run is using these data.
  explicit ProcessUse(const ResolvedSystem& system);
  ~ProcessUse();
  ProcessUse(const ProcessUse&) = delete;
  ProcessUse& operator=(const ProcessUse&) = delete;

 private:
  std::vector<std::string_view> used_;
};

}  // namespace mebots::master
