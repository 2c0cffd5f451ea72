// SPDX-License-Identifier: Apache-2.0
#include "behaviour_check.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace mebots::check {
namespace {

constexpr const char* kPassStopTime =
    "in MEbots, set \"pass_stop_time\": true for the instance; stopTime is optional in FMI 2.0, so the FMU should run "
    "without it";

using master::Experiment;

/// True if the FMU accepts these arguments and performs one step. Otherwise, sets `why` to the error.
bool starts(const Library& library, const Experiment& experiment, std::string& why) {
  try {
    Instance instance(library, "experiment");
    instance.start(experiment);
    instance.run(0, 1);
    return true;
  } catch (const Refused& refused) {
    why = refused.what();
    return false;
  }
}

Experiment with_stop_time(const Target& target) {
  auto experiment = target.experiment;
  experiment.stop_ns = target.end_ns();
  return experiment;
}

void check_start_without_stop_time(const Library& library) {
  const auto& target = library.target();
  std::string why;
  std::string ignored;
  if (starts(library, target.experiment, why) || !starts(library, with_stop_time(target), ignored)) return;
  library.witness().error(fmt::format("it needs a stop time, and most tools pass none: {}", why), kPassStopTime);
}

/// Returns the outputs at all communication points.
std::vector<Outputs> run_of(const Library& library, const Experiment& experiment) {
  Instance instance(library, "experiment");
  instance.start(experiment);
  std::vector<Outputs> points{instance.outputs()};
  for (int k = 0; k < library.target().steps && !instance.ended(); ++k) {
    instance.run(k, k + 1);
    points.push_back(instance.outputs());
  }
  return points;
}

void check_values_with_stop_time(const Library& library) {
  const auto& target = library.target();
  if (target.experiment.stop_ns) return;  // the FMU only starts with a stop time
  const auto without = run_of(library, target.experiment);
  if (run_of(library, target.experiment) != without) return;  // equal runs have different results
  const auto with = run_of(library, with_stop_time(target));
  if (with.size() != without.size()) {
    library.witness().warning(fmt::format("with a stop time the FMU ends after {} steps, without one after {}",
                                          with.size() - 1, without.size() - 1),
                              "compute up to t + h in each step, whatever the stop time");
    return;
  }
  for (std::size_t k = 0; k < with.size(); ++k) {
    const auto difference = library.difference(with[k], without[k]);
    if (difference.empty()) continue;
    library.witness().warning(
        fmt::format("values depend on the stop time: at {} s, with stopTime {} s compared with none, {}",
                    static_cast<double>(k) * target.step_s, static_cast<double>(target.end_ns()) * 1e-9, difference),
        "compute up to t + h in each step, whatever the stop time; MEbots passes none unless the config sets "
        "\"pass_stop_time\": true");
    return;
  }
}

}  // namespace

Probe start_probe() {
  return {"the FMU needs no stop time", check_start_without_stop_time, "", Severity::error, Level::interoperable};
}

bool says_stop_time_is_needed(const Check& check) {
  return std::ranges::find(check.findings, kPassStopTime, &Finding::way_out) != check.findings.end();
}

Probe stop_time_probe() {
  return {"a stop time changes no value before it", check_values_with_stop_time, "", Severity::error,
          Level::interoperable};
}

}  // namespace mebots::check
