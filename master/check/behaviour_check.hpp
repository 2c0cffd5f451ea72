// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subject.hpp"
#include "trace_file.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace mebots::check {

/// An experiment on an FMU. Runs in its own child process.
struct Probe {
  std::string name;  ///< the property that holds if the probe finds no error
  std::function<void(const Library&)> run;
  std::string skipped;  ///< reason why the probe does not apply; empty if it applies
  Severity crash = Severity::error;
  Level level = Level::standard;
};

/// Returns probes that run the FMU, reset it, restore states, halve steps, replay a run, and detect memory leaks. The
/// second probe is a plain run. If one of the first two probes fails, all later probes are skipped.
std::vector<Probe> life_probes(const Target& target, double half_step_tolerance);
/// Returns a probe that detects whether the FMU only starts with a stop time. If so, all other probes pass a stop time.
Probe start_probe();
/// True if start_probe() found that the FMU only starts with a stop time.
bool says_stop_time_is_needed(const Check& check);
/// Returns a probe that compares runs with and without a stop time.
Probe stop_time_probe();
/// Returns probes with calls that the standard forbids. The FMU must return an error.
std::vector<Probe> illegal_call_probes(const Target& target);

/// Returns the columns of the reference traces that can be compared with a run. Traces in documentation/reference
/// belong to this FMU alone. Their columns count even without a numeric variable of the same name; replay() reports
/// such columns.
TraceScope scope_of(const std::optional<TraceFiles>& files, const ModelDescription& model);
/// Compares a run with the reference traces.
void replay(const Library& library, const TraceFiles& files);

}  // namespace mebots::check
