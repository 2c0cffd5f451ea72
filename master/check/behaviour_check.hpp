// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subject.hpp"
#include "trace_file.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace mebots::check {

/// An experiment with the FMU, run in a separate child process.
struct Probe {
  std::string name;  ///< a statement that holds if the probe finds no error
  std::function<void(const Library&)> run;
  std::string skipped;  ///< why it does not apply to this FMU; empty if it applies
  Severity crash = Severity::error;
  Level level = Level::standard;
};

/// Returns probes that run, reset, save, halve steps, replay and count leaks. The second is a plain run: if it fails,
/// the others are skipped.
std::vector<Probe> life_probes(const Target& target, double half_step_tolerance);
/// Returns the probe that detects an FMU which starts only with a stop time. Such an FMU then gets a stop time in all
/// other experiments.
Probe start_probe();
/// True if start_probe() has found such an FMU.
bool says_stop_time_is_needed(const Check& check);
/// Compares a run with a stop time with a run without.
Probe stop_time_probe();
/// Returns probes with calls that the standard forbids. The FMU must return an error.
std::vector<Probe> illegal_call_probes(const Target& target);

/// Returns the part of the reference traces that a run can be compared with. Traces in documentation/reference belong
/// to this FMU. Therefore a column that is not a numeric variable of the FMU is not left out, and replay() reports it.
TraceScope scope_of(const std::optional<TraceFiles>& files, const ModelDescription& model);
/// Compares a run with the reference traces.
void replay(const Library& library, const TraceFiles& files);

}  // namespace mebots::check
