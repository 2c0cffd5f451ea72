// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/process/process_functions.hpp"
#include "mebots/run_state.hpp"
#include "model/resolved_system.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Finds FMUs whose data could change the next run in the same process.
namespace mebots::master {

/// Returns the FMUs that left data in this process, with the reasons (see LibraryState). All instances must have been
/// freed.
std::vector<Leftover> leftovers_of(const ResolvedSystem& system);

/// Names the first instance whose FMU computes with data outside its instances, with the reason. Returns nullopt if no
/// FMU does.
std::optional<std::string> fmu_without_whole_state(const ResolvedSystem& system);
/// Throws InputError if an FMU computes with data outside its instances. `what` names the call that needs the complete
/// state.
void require_whole_states(const ResolvedSystem& system, std::string_view what);

/// Protects data of the C library, such as the state of rand(), that FMUs share with the whole process. If FMUs of the
/// run import functions that change such data, resets the data or rejects the run.
class ProcessUse {
 public:
  /// Resets the data of the C library that FMUs of the run may change, if they can be reset. Throws InputError, which
  /// names the FMU and the function, if another current run may change the same data, or if an earlier run may have
  /// changed data that cannot be reset.
  explicit ProcessUse(const ResolvedSystem& system);
  ~ProcessUse();
  ProcessUse(const ProcessUse&) = delete;
  ProcessUse& operator=(const ProcessUse&) = delete;

 private:
  std::vector<std::string_view> used_;
};

}  // namespace mebots::master
