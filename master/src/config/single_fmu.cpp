// SPDX-License-Identifier: Apache-2.0
#include "config/single_fmu.hpp"

#include "base/time.hpp"
#include "config/system_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mebots::master::config {
namespace {

using modeldesc::Causality;
using modeldesc::Type;

constexpr double kDefaultLength_s = 1;
constexpr std::int64_t kDefaultSteps = 500;
constexpr const char* kByDefault = "by default";
constexpr const char* kByFmu = "DefaultExperiment of the FMU";

/// A time and where it comes from.
struct Origin {
  std::int64_t time_ns = 0;
  std::string text;
};

/// The time of a DefaultExperiment in whole nanoseconds, if it is one that a run can have.
std::optional<std::int64_t> usable_ns(std::optional<double> time_s) {
  if (!time_s || !std::isfinite(*time_s) || std::abs(*time_s) > kLongestTimeS) return std::nullopt;
  return static_cast<std::int64_t>(std::llround(*time_s * 1e9));
}

/// What the user gives must be exact; nothing for a time that is not given.
std::optional<std::int64_t> given_ns(std::optional<double> time_s, const char* option) {
  if (!time_s) return std::nullopt;
  const auto time_ns = to_nanoseconds(*time_s);
  if (!time_ns || *time_ns <= 0) {
    throw InputError(ErrorCode::value_out_of_range,
                     fmt::format("{} {}: this must be a whole number of nanoseconds greater than 0", option, *time_s));
  }
  return time_ns;
}

Origin start_of(const modeldesc::DefaultExperiment& experiment) {
  if (const auto time_ns = usable_ns(experiment.start_time_s)) return {*time_ns, kByFmu};
  return {0, kByDefault};
}

Origin stop_of(const modeldesc::DefaultExperiment& experiment, const GivenTimes& times, std::int64_t start_ns) {
  if (const auto time_ns = given_ns(times.stop_time_s, "--stop-time")) return {*time_ns, "--stop-time"};
  const auto time_ns = usable_ns(experiment.stop_time_s);
  if (time_ns && *time_ns > start_ns) return {*time_ns, kByFmu};
  return {start_ns + static_cast<std::int64_t>(kDefaultLength_s * 1e9), kByDefault};
}

Origin step_of(const modeldesc::DefaultExperiment& experiment, const GivenTimes& times, std::int64_t length_ns) {
  if (const auto time_ns = given_ns(times.step_s, "--step")) return {*time_ns, "--step"};
  const auto time_ns = usable_ns(experiment.step_size_s);
  if (time_ns && *time_ns > 0 && *time_ns <= length_ns) return {*time_ns, kByFmu};
  const auto text = fmt::format("a part in {} of the run, {}", kDefaultSteps, kByDefault);
  return {std::max<std::int64_t>(length_ns / kDefaultSteps, 1), text};
}

bool has_output(const modeldesc::ModelDescription& description) {
  return std::ranges::any_of(description.variables, [](const modeldesc::Variable& variable) {
    return variable.causality == Causality::output && variable.type != Type::string;
  });
}

}  // namespace

nlohmann::ordered_json single_fmu_config(const std::filesystem::path& fmu,
                                         const modeldesc::ModelDescription& description, const GivenTimes& times,
                                         std::vector<std::string>& notices) {
  const auto& experiment = description.default_experiment;
  const auto start = start_of(experiment);
  auto stop = stop_of(experiment, times, start.time_ns);
  const auto length_ns = std::max<std::int64_t>(stop.time_ns - start.time_ns, 1);
  const auto step = step_of(experiment, times, length_ns);
  if (const auto rest_ns = length_ns % step.time_ns; !times.stop_time_s && rest_ns != 0) {
    const auto steps = std::max<std::int64_t>(length_ns / step.time_ns, 1);
    stop.text += fmt::format(", there {} s, here after a whole number of steps", to_seconds(stop.time_ns));
    stop.time_ns = start.time_ns + steps * step.time_ns;
  }
  const auto name = system_name(fmu);
  notices.push_back(fmt::format("{}: runs alone from {} s ({}) to {} s ({}) with a step of {} s ({})", name,
                                to_seconds(start.time_ns), start.text, to_seconds(stop.time_ns), stop.text,
                                to_seconds(step.time_ns), step.text));
  nlohmann::ordered_json config;
  config["step"] = to_seconds(step.time_ns);
  config["start_time"] = to_seconds(start.time_ns);
  config["stop_time"] = to_seconds(stop.time_ns);
  config["instances"][name]["fmu"] = std::filesystem::absolute(fmu).string();
  config["connections"] = nlohmann::ordered_json::array();
  if (!has_output(description)) {
    notices.push_back(fmt::format("{}: the FMU has no outputs, so its local variables are recorded", name));
    config["record"]["locals"] = true;
  }
  return config;
}

}  // namespace mebots::master::config
