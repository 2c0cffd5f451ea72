// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace mebots {

/// The states of a run, in the order in which they occur. Each of the first three states can change to `failed`.
enum class RunState {
  open,     ///< the config was read; settings can be changed
  ready,    ///< all FMUs are initialised, at t = 0 or at the time of the checkpoint
  running,  ///< at least one communication step was taken
  ended,    ///< the run has ended or was interrupted; its reports are written
  failed,   ///< the run ended with an error; FMUs are no longer called
};

/// The reason why a run ended.
enum class EndReason {
  stop_time,       ///< the stop time was reached
  stop_condition,  ///< a condition in `stop_when` of the config became true
  terminated,      ///< an FMU requested the end of the run
  interrupted,     ///< interrupt() was called, or a signal was received
  closed,          ///< close() was called before the end
  failed,          ///< an error occurred
};

/// Returns the name of a state, such as "ready".
std::string_view name_of(RunState state);
/// Returns the name of a reason as in summary.json, such as "stop_time".
std::string_view name_of(EndReason reason);

/// An FMU that may affect later runs. `text` contains the reason, such as "o.fmu: it imports srand(), which changes
/// random numbers".
struct Leftover {
  std::string text;
  /// True if the FMU ran in this process and can therefore affect later runs in it.
  bool in_process = false;
};

}  // namespace mebots
