// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subject.hpp"
#include "trace_file.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace mebots::check {

/// An experiment with the FMU. Each probe runs in a separate child process.
struct Probe {
  std::string name;  ///< a statement that holds if the probe finds no error
  std::function<void(const Library&)> run;
  std::string skipped;  ///< why it does not apply to this FMU; empty if it applies
  Severity crash = Severity::error;
  Level level = Level::standard;
};

/// Returns probes that run, reset, save, halve steps, replay and count leaks. The second probe is a plain run. If the
/// plain run fails, all other probes are skipped.
std::vector<Probe> life_probes(const Target& target, double half_step_tolerance);
/// Returns the probe that detects an FMU which starts only with a stop time. All other experiments pass a stop time to
/// such an FMU.
Probe start_probe();
/// True if start_probe() has found that the FMU starts only with a stop time.
bool says_stop_time_is_needed(const Check& check);
/// Compares a run with a stop time and a run without a stop time.
Probe stop_time_probe();
/// Returns probes with calls that the standard forbids. The FMU must return an error.
std::vector<Probe> illegal_call_probes(const Target& target);

/// Returns the part of the reference traces with which a run can be compared. Traces in documentation/reference belong
/// to this FMU. Therefore the part includes columns that are no numeric variables of the FMU, and replay() reports
/// them.
TraceScope scope_of(const std::optional<TraceFiles>& files, const ModelDescription& model);
/// Compares a run with the reference traces.
void replay(const Library& library, const TraceFiles& files);

}  // namespace mebots::check
