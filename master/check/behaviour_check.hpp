// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subject.hpp"

#include <functional>
#include <string>
#include <vector>

namespace mebots::check {

/// One experiment with the FMU, run in a child process of its own.
struct Probe {
  std::string name;  ///< what holds when it finds nothing
  std::function<void(const Library&)> run;
  std::string skipped;  ///< why it does not apply to this FMU; empty when it does
  Severity crash = Severity::error;
  Level level = Level::standard;
};

/// Runs, resets, saves, halves steps, replays and counts what is left behind. The second is a plain run: when it fails,
/// the others have nothing to say.
std::vector<Probe> life_probes(const Target& target, double half_step_tolerance);
/// Finds an FMU that starts with a stop time only. Such an FMU gets one in all other experiments.
Probe start_probe();
/// Returns whether that probe found such an FMU.
bool says_stop_time_is_needed(const Check& check);
/// Compares a run with a stop time with a run without.
Probe stop_time_probe();
/// Calls that the standard forbids, which must be answered by an error.
std::vector<Probe> illegal_call_probes(const Target& target);

}  // namespace mebots::check
