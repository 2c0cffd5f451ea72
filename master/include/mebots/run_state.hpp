// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace mebots {

/// Where a run stands. A run goes through the states from top to bottom; `failed` can follow each of the first three.
enum class RunState {
  open,     ///< described; settings can still change
  ready,    ///< every FMU is initialised, and the run stands at t = 0 or at the checkpoint that it resumes
  running,  ///< at least one communication step was taken
  ended,    ///< the end was reached, or the run was interrupted or closed; the reports are written
  failed,   ///< an error ended it; the reports are written as far as it came. No FMU is called any more
};

/// Why a run ended.
enum class EndReason {
  stop_time,       ///< the stop time was reached
  stop_condition,  ///< a condition of the config's `stop_when` held
  terminated,      ///< an FMU asked for the end (fmi2Discard with fmi2Terminated)
  interrupted,     ///< interrupt(), Ctrl-C, SIGTERM
  closed,          ///< close() before the end
  failed,          ///< an error
};

/// "ready"
std::string_view name_of(RunState state);
/// "stop_time", as summary.json has it
std::string_view name_of(EndReason reason);

/// An FMU that is not clean, and why: "o.fmu: it imports srand(), which changes random numbers".
struct Leftover {
  std::string text;
  bool in_process = false;  ///< it ran in this process, whose next run might find what it left
};

}  // namespace mebots
