// SPDX-License-Identifier: Apache-2.0
#include "model/statistics.hpp"

#include "base/time.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace mebots::master {
namespace {

double master_time_s(const Statistics& statistics, double total_s) {
  double instances_s = 0;
  for (const auto& instance : statistics.instances) instances_s += instance.time_s;
  return std::max(0.0, total_s - instances_s);
}

double share(double time_s, double total_s) {
  return total_s > 0 ? time_s / total_s : 0;
}

}  // namespace

nlohmann::ordered_json statistics_json(const Statistics& statistics, double total_s) {
  nlohmann::ordered_json json;
  auto& instances = json["instances"] = nlohmann::ordered_json::object();
  for (const auto& instance : statistics.instances) {
    instances[instance.name] = {
        {"calls", instance.calls},
        {"steps", instance.steps},
        {"time", instance.time_s},
        {"share", share(instance.time_s, total_s)},
        {"mean_step", instance.steps > 0 ? instance.step_time_s / static_cast<double>(instance.steps) : 0},
        {"slowest_step", instance.slowest_s},
        {"slowest_step_at", to_seconds(instance.slowest_at_ns)}};
  }
  const auto master_s = master_time_s(statistics, total_s);
  json["master"] = {{"time", master_s}, {"share", share(master_s, total_s)}};
  json["total"] = total_s;
  return json;
}

std::vector<std::string> statistics_table(const Statistics& statistics, double total_s) {
  std::size_t width = std::string_view("instance").size();
  for (const auto& instance : statistics.instances) width = std::max(width, instance.name.size());
  std::vector<std::string> lines = {fmt::format("{:<{}} {:>11} {:>11} {:>10} {:>7} {:>13} {:>13} {:>12}", "instance",
                                                width, "calls", "steps", "time [s]", "share", "mean step[us]",
                                                "slowest [us]", "at t = [s]")};
  for (const auto& instance : statistics.instances) {
    const double mean_us = instance.steps > 0 ? instance.step_time_s / static_cast<double>(instance.steps) * 1e6 : 0;
    lines.push_back(fmt::format("{:<{}} {:>11} {:>11} {:>10.4f} {:>6.1f}% {:>13.2f} {:>13.1f} {:>12}", instance.name,
                                width, instance.calls, instance.steps, instance.time_s,
                                100 * share(instance.time_s, total_s), mean_us, instance.slowest_s * 1e6,
                                to_seconds(instance.slowest_at_ns)));
  }
  const auto master_s = master_time_s(statistics, total_s);
  lines.push_back(fmt::format("{:<{}} {:>11} {:>11} {:>10.4f} {:>6.1f}%", "master", width, "", "", master_s,
                              100 * share(master_s, total_s)));
  return lines;
}

nlohmann::ordered_json solvers_json(const std::vector<SolverStatistics>& solvers) {
  auto json = nlohmann::ordered_json::array();
  for (const auto& solver : solvers) {
    const auto& counts = solver.counts;
    json.push_back({{"instances", solver.members},
                    {"states", solver.states},
                    {"event_indicators", solver.event_indicators},
                    {"relative_tolerance", solver.relative_tolerance},
                    {"steps", counts.steps},
                    {"rejected_steps", counts.rejected_steps},
                    {"evaluations", counts.evaluations},
                    {"jacobians", counts.jacobians},
                    {"restarts", counts.restarts},
                    {"state_events", counts.state_events},
                    {"time_events", counts.time_events},
                    {"step_events", counts.step_events},
                    {"input_events", counts.input_events}});
  }
  return json;
}

std::vector<std::string> solvers_table(const std::vector<SolverStatistics>& solvers) {
  std::vector<std::string> lines;
  for (const auto& solver : solvers) {
    const auto& counts = solver.counts;
    const auto events = counts.state_events + counts.time_events + counts.step_events + counts.input_events;
    lines.push_back(
        fmt::format("solver of {}: {} steps, {} rejected, {} evaluations, {} Jacobians, {} events, {} restarts; {} "
                    "states, relative "
                    "tolerance {}",
                    fmt::join(solver.members, ", "), counts.steps, counts.rejected_steps, counts.evaluations,
                    counts.jacobians, events, counts.restarts, solver.states, solver.relative_tolerance));
  }
  return lines;
}

nlohmann::ordered_json step_control_json(const ResolvedSystem& system, const StepStatistics& steps) {
  const auto& description = *system.description;
  nlohmann::ordered_json json = {
      {"steps", steps.steps},
      {"rejected_steps", steps.rejected},
      {"steps_above_tolerance", steps.above},
      {"smallest_step", to_seconds(description.length_of(steps.smallest))},
      {"largest_step", to_seconds(description.length_of(steps.largest))},
      {"mean_error", steps.steps > 0 ? steps.error_sum / static_cast<double>(steps.steps) : 0},
      {"largest_error", steps.largest_error},
      {"rolls_back", system.step_control->rolls_back}};
  auto& worst = json["largest_error_in"] = nlohmann::ordered_json::object();
  const auto& measured = system.step_control->measured;
  for (std::size_t i = 0; i < measured.size(); ++i) worst[measured[i].name] = steps.worst[i];
  return json;
}

std::string step_control_line(const ResolvedSystem& system, const StepStatistics& steps) {
  const auto& description = *system.description;
  auto line = fmt::format("step control: {} steps of {} to {} s, {} repeated, {} above the tolerance", steps.steps,
                          to_seconds(description.length_of(steps.smallest)),
                          to_seconds(description.length_of(steps.largest)), steps.rejected, steps.above);
  const auto worst = std::ranges::max_element(steps.worst);
  if (*worst == 0) return line;
  const auto& measured = system.step_control->measured;
  return line + fmt::format("; the error is most often the largest in {} ({} steps)",
                            measured[static_cast<std::size_t>(worst - steps.worst.begin())].name, *worst);
}

}  // namespace mebots::master
