// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace mebots {

/// The states of a run, in the order in which they occur. A run can become `failed` from each of the first three
/// states.
enum class RunState {
  open,     ///< the system is described; settings can be changed
  ready,    ///< all FMUs are initialised; the time is t = 0, or the time of the checkpoint from which the run resumes
  running,  ///< at least one communication step was taken
  ended,    ///< the run has ended, was interrupted or was closed; its reports are written
  failed,   ///< an error ended the run; the reports contain the results before the error; no FMU is called any longer
};

/// The reason why a run ended.
enum class EndReason {
  stop_time,       ///< the stop time was reached
  stop_condition,  ///< a condition in `stop_when` of the config became true
  terminated,      ///< an FMU requested the end (fmi2Discard with fmi2Terminated)
  interrupted,     ///< interrupt() was called, or Ctrl-C or SIGTERM was received
  closed,          ///< close() was called before the end
  failed,          ///< an error occurred
};

/// Returns the name of a state, such as "ready".
std::string_view name_of(RunState state);
/// Returns the name of a reason in summary.json, such as "stop_time".
std::string_view name_of(EndReason reason);

/// Describes an FMU that may affect later runs, and the reason, such as "o.fmu: it imports srand(), which changes
/// random numbers".
struct Leftover {
  std::string text;
  /// True if the FMU ran in this process, so that it could affect the next run in this process.
  bool in_process = false;
};

}  // namespace mebots
