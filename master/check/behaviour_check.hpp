// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subject.hpp"

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

/// Reference traces inside an FMU: `documentation/reference/<name>_in.csv` and `<name>_out.csv`, or the result named in
/// `extra/org.fmi-standard.fmi-ls-ref/fmi-ls-manifest.xml` with its `_in.csv` in the same folder.
struct TraceFiles {
  std::filesystem::path inputs;  ///< empty if absent
  std::filesystem::path outputs;
  /// True if the file serves the FMI 2.0 and 3.0 versions of a model. Columns that this FMU lacks, or has as text, are
  /// then ignored.
  bool of_many_versions = false;
};

/// Returns the traces of an unpacked FMU, if it has any.
std::optional<TraceFiles> find_traces(const std::filesystem::path& folder);

/// Steps from row to row of the output file with the latest inputs, and compares. Reals may differ by 1e-6 of their
/// value, because compilers round differently; all other values must be equal. Reports the first divergence.
void replay(const Library& library, const TraceFiles& files);

}  // namespace mebots::check
