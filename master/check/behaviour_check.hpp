// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subject.hpp"
#include "trace_file.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace mebots::check {

/// An experiment on the FMU. Each probe runs in a separate child process.
struct Probe {
  std::string name;  ///< a statement that is true if the probe finds no error
  std::function<void(const Library&)> run;
  std::string skipped;  ///< why the probe does not apply to this FMU; empty if it applies
  Severity crash = Severity::error;
  Level level = Level::standard;
};

/// Returns probes that run the FMU, reset it, save its state, halve its steps, replay a run, and count memory leaks.
/// The second probe is a plain run. If the plain run fails, all other probes are skipped.
std::vector<Probe> life_probes(const Target& target, double half_step_tolerance);
/// Returns the probe that detects whether the FMU starts only if it receives a stop time. If so, all other experiments
/// pass a stop time.
Probe start_probe();
/// True if start_probe() has found that the FMU starts only with a stop time.
bool says_stop_time_is_needed(const Check& check);
/// Returns a probe that compares a run with a stop time and a run without a stop time.
Probe stop_time_probe();
/// Returns probes that make calls which the standard forbids. The FMU must return an error.
std::vector<Probe> illegal_call_probes(const Target& target);

/// Returns which columns of the reference traces can be compared with a run. Traces in documentation/reference belong
/// to this FMU alone. Therefore, their columns count even if they are no numeric variables of the FMU; replay() reports
/// such columns.
TraceScope scope_of(const std::optional<TraceFiles>& files, const ModelDescription& model);
/// Compares a run with the reference traces.
void replay(const Library& library, const TraceFiles& files);

}  // namespace mebots::check
