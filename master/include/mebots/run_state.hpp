// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace mebots {

/// The states of a run, in the order in which they occur. A run can become `failed` from each of the first three
/// states.
enum class RunState {
  open,     ///< the system is described; settings can still change
  ready,    ///< every FMU is initialised; the time is t = 0, or that of the resumed checkpoint
  running,  ///< at least one communication step was taken
  ended,    ///< the run is over, was interrupted or closed; the reports are written
  failed,   ///< an error ended the run; the reports contain the part before it. No FMU is called after it
};

/// The reason why a run ended.
enum class EndReason {
  stop_time,       ///< the stop time was reached
  stop_condition,  ///< a condition of the config's `stop_when` held
  terminated,      ///< an FMU requested the end (fmi2Discard with fmi2Terminated)
  interrupted,     ///< interrupt(), Ctrl-C, SIGTERM
  closed,          ///< close() before the end
  failed,          ///< an error
};

/// Returns the name of a state, such as "ready".
std::string_view name_of(RunState state);
/// Returns the name of a reason in summary.json, such as "stop_time".
std::string_view name_of(EndReason reason);

/// An FMU that is not clean, with the reason, such as "o.fmu: it imports srand(), which changes random numbers".
struct Leftover {
  std::string text;
  bool in_process = false;  ///< it ran in this process, so that the next run here could be affected
};

}  // namespace mebots
