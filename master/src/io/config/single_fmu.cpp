// SPDX-License-Identifier: Apache-2.0
#include "io/config/load_system.hpp"

#include "base/time.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mebots::master::config {
namespace {

using modeldesc::Causality;
using modeldesc::Type;

constexpr double kDefaultLength_s = 1;
constexpr std::int64_t kDefaultSteps = 500;
constexpr const char* kByDefault = "by default";
constexpr const char* kByFmu = "DefaultExperiment of the FMU";

struct Origin {
  ExactTime time;
  std::string text;
};

/// Returns a time of a DefaultExperiment, which is rounded to nanoseconds if it is not exact; nullopt if a run cannot
/// have this time.
std::optional<ExactTime> usable(std::optional<double> time_s) {
  if (!time_s || !std::isfinite(*time_s) || std::abs(*time_s) > kLongestTimeS) return std::nullopt;
  if (const auto time = exact_time(*time_s)) return time;
  return exact_time_of(std::llround(*time_s * 1e9));
}

/// Returns a time of the user. Throws InputError if it cannot be represented exactly.
ExactTime given(const WrittenTime& written, const char* option) {
  const auto* seconds = std::get_if<double>(&written);
  const auto time = seconds != nullptr ? exact_time(*seconds) : read_ratio(std::get<std::string>(written));
  if (time) return *time;
  throw InputError(ErrorCode::value_out_of_range,
                   fmt::format("{} {}: this must be a whole number of nanoseconds or a ratio such as 1/60", option,
                               time_text(written)));
}

std::int64_t start_of(const modeldesc::DefaultExperiment& experiment, std::string& origin) {
  const auto time = usable(experiment.start_time_s);
  origin = time ? kByFmu : kByDefault;
  return time ? to_nanoseconds(*time) : 0;
}

Origin stop_of(const modeldesc::DefaultExperiment& experiment, const GivenTimes& times, std::int64_t start_ns) {
  if (times.stop_time_s) return {given(*times.stop_time_s, "--stop-time"), "--stop-time"};
  const auto time = usable(experiment.stop_time_s);
  if (time && to_nanoseconds(*time) > start_ns) return {*time, kByFmu};
  return {exact_time_of(start_ns + static_cast<std::int64_t>(kDefaultLength_s * 1e9)), kByDefault};
}

bool is_step(const ExactTime& time, std::int64_t length_ns) {
  const auto time_ns = to_nanoseconds(time);
  return time.numerator > 0 && time_ns <= length_ns &&
         time_ns >= (time.is_whole_nanoseconds() ? 1 : TimeGrid::kShortestRatioNs);
}

Origin step_of(const modeldesc::DefaultExperiment& experiment, const GivenTimes& times, std::int64_t length_ns) {
  if (times.step) {
    const auto step = given(*times.step, "--step");
    if (is_step(step, std::numeric_limits<std::int64_t>::max())) return {step, "--step"};
    throw InputError(ErrorCode::value_out_of_range,
                     fmt::format("--step {}: this must be a time greater than 0 s, and a ratio at least {} ns",
                                 time_text(*times.step), TimeGrid::kShortestRatioNs));
  }
  const auto step = usable(experiment.step_size_s);
  if (step && is_step(*step, length_ns)) return {*step, kByFmu};
  const auto text = fmt::format("1/{} of the run, {}", kDefaultSteps, kByDefault);
  const auto part = reduced(length_ns, WideInteger{kDefaultSteps} * kNanosecondsPerSecond);
  const bool fits = part.denominator <= kNanosecondsPerSecond && is_step(part, length_ns);
  return {fits ? part : exact_time_of(std::max<std::int64_t>(length_ns / kDefaultSteps, 1)), text};
}

nlohmann::ordered_json json_of_time(const ExactTime& time) {
  if (time.is_whole_nanoseconds()) return to_seconds(time);
  return time_text(time);
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
  std::string start_text;
  const auto start_ns = start_of(experiment, start_text);
  auto [stop, stop_text] = stop_of(experiment, times, start_ns);
  auto stop_ns = to_nanoseconds(stop);
  const auto step = step_of(experiment, times, std::max<std::int64_t>(stop_ns - start_ns, 1));
  const TimeGrid grid(start_ns, step.time);
  if (!times.stop_time_s && !grid.is_point(stop_ns)) {
    stop_text += fmt::format(", {} s rounded to a whole number of steps", to_seconds(stop_ns));
    stop_ns = grid.time_ns(std::max<std::int64_t>(grid.point_at(stop_ns), 1));
  }
  const auto name = system_name(fmu);
  notices.push_back(fmt::format("{}: runs alone from {} s ({}) to {} s ({}) with a step of {} s ({})", name,
                                to_seconds(start_ns), start_text, grid.time_s(stop_ns), stop_text, time_text(step.time),
                                step.text));
  nlohmann::ordered_json config;
  config["step"] = json_of_time(step.time);
  config["start_time"] = to_seconds(start_ns);
  config["stop_time"] = to_seconds(stop_ns);
  config["instances"][name]["fmu"] = std::filesystem::absolute(fmu).string();
  config["connections"] = nlohmann::ordered_json::array();
  if (!has_output(description)) {
    notices.push_back(fmt::format("{}: the FMU has no outputs, so its local variables are recorded", name));
    config["record"]["locals"] = true;
  }
  return config;
}

}  // namespace mebots::master::config
