// SPDX-License-Identifier: Apache-2.0
#include "model/system_description.hpp"

#include "base/time.hpp"
#include "mebots/assert.hpp"
#include "mebots/nearest_names.hpp"

#include <fmt/format.h>

#include <variant>

namespace mebots::master {

std::optional<std::size_t> InstanceIndex::find(const std::vector<InstanceDescription>& instances,
                                               std::string_view name) const {
  if (known_ > instances.size()) {
    places_.clear();
    known_ = 0;
  }
  if (known_ < instances.size()) places_.reserve(instances.size());
  for (; known_ < instances.size(); ++known_) places_.emplace(instances[known_].name, known_);
  const auto found = places_.find(name);
  if (found == places_.end()) return std::nullopt;
  MEBOTS_ASSERT(instances[found->second].name == name, "an instance keeps its name once it was looked for");
  return found->second;
}

std::optional<std::size_t> SystemDescription::index_of(std::string_view instance_name) const {
  return index.find(instances, instance_name);
}

const InstanceDescription* SystemDescription::find_instance(std::string_view instance_name) const {
  const auto place = index_of(instance_name);
  return place ? &instances[*place] : nullptr;
}

std::vector<std::string> SystemDescription::instance_names() const {
  std::vector<std::string> names;
  for (const auto& instance : instances) names.push_back(instance.name);
  return names;
}

std::optional<VariableName> SystemDescription::split(std::string_view text) const {
  // No instance name followed by a dot is the beginning of another name. At most one prefix of the text is therefore an
  // instance.
  for (auto dot = text.find('.'); dot != std::string_view::npos; dot = text.find('.', dot + 1)) {
    const auto instance = text.substr(0, dot);
    if (dot + 1 < text.size() && find_instance(instance) != nullptr) {
      return VariableName{std::string(instance), std::string(text.substr(dot + 1))};
    }
  }
  if (single_fmu && !text.empty()) return VariableName{instances.front().name, std::string(text)};
  return std::nullopt;
}

ExactTime SystemDescription::length_of(std::int64_t count) const {
  return reduced(WideInteger{step.numerator} * count, step.denominator);
}

ExactTime SystemDescription::step_of(const InstanceDescription& instance) const {
  return length_of(instance.steps);
}

std::optional<std::string> stop_time_problem(const SystemDescription& system, std::int64_t stop_time_ns) {
  const auto start_ns = system.start_time_ns;
  if (stop_time_ns <= start_ns) {
    if (start_ns == 0) return "the stop time must be greater than 0 s";
    return fmt::format("the stop time {} s must be greater than the start time {} s", to_seconds(stop_time_ns),
                       to_seconds(start_ns));
  }
  if (WideInteger{stop_time_ns} - start_ns >
      WideInteger{static_cast<std::int64_t>(kLongestTimeS)} * kNanosecondsPerSecond)
    return fmt::format("the run would last longer than {} s", kLongestTimeS);
  if (system.step.numerator <= 0) return std::nullopt;  // the step is invalid
  const auto grid = system.grid();
  const auto after_start = start_ns == 0 ? "" : fmt::format(" after the start time {} s", to_seconds(start_ns));
  const auto last = grid.point_at(stop_time_ns);
  const auto problem = [&](std::int64_t steps, const std::string& whose,
                           const ExactTime& step) -> std::optional<std::string> {
    const auto below = last / steps * steps;
    if (below == last && grid.time_ns(last) == stop_time_ns) return std::nullopt;
    return fmt::format("the stop time {} s is not a multiple of the step {} s{}{}; the nearest are {} s and {} s",
                       to_seconds(stop_time_ns), time_text(step), whose, after_start, grid.time_s(grid.time_ns(below)),
                       grid.time_s(grid.time_ns(below + steps)));
  };
  if (auto found = problem(1, "", system.step)) return found;
  for (const auto& instance : system.instances) {
    if (instance.steps == 1) continue;
    const auto whose = fmt::format(" of instance '{}'", instance.name);
    if (auto found = problem(instance.steps, whose, system.step_of(instance))) return found;
  }
  return std::nullopt;
}

void set_stop_time(SystemDescription& system, std::int64_t stop_time_ns, const std::string& place) {
  if (const auto problem = stop_time_problem(system, stop_time_ns)) {
    throw InputError(ErrorCode::invalid_value, fmt::format("{}: {}", place, *problem));
  }
  system.stop_time_ns = stop_time_ns;
}

VariableName parse_variable(const SystemDescription& system, std::string_view text, const std::string& place) {
  if (auto name = system.split(text)) return *name;
  const auto dot = text.find('.');
  if (dot == std::string_view::npos || dot == 0 || dot + 1 == text.size()) {
    throw InputError(ErrorCode::syntax_error,
                     fmt::format("{}: '{}' does not name a variable; write instance.variable", place, text));
  }
  return {std::string(text.substr(0, dot)), std::string(text.substr(dot + 1))};
}

LocatedSetting locate(SystemDescription& system, const Setting& setting) {
  const auto name = parse_variable(system, setting.variable, setting.place);
  const auto found = system.index_of(name.instance);
  if (!found) {
    throw InputError(ErrorCode::unknown_name,
                     fmt::format("{}: there is no instance '{}'. {}", setting.place, name.instance,
                                 suggest(name.instance, system.instance_names())));
  }
  return {&system.instances[*found], {name.variable, setting.value, setting.place}};
}

const AlgorithmKind& find_algorithm(const AlgorithmDescription& description) {
  const auto* found = std::ranges::find(kAlgorithms, description.type, &AlgorithmKind::name);
  if (found == std::end(kAlgorithms)) {
    std::vector<std::string> names;
    for (const auto& kind : kAlgorithms) names.emplace_back(kind.name);
    throw InputError(ErrorCode::unknown_name,
                     fmt::format("there is no algorithm '{}'. {}", description.type, suggest(description.type, names)));
  }
  if (!found->takes_order && !description.order.empty()) {
    throw InputError(ErrorCode::invalid_value,
                     fmt::format("'{}' steps all instances with the same values, so it has no order", found->name));
  }
  return *found;
}

std::string written_text(const WrittenValue& written) {
  struct Show {
    std::string operator()(double value) const { return fmt::format("{}", value); }
    std::string operator()(std::int64_t value) const { return fmt::format("{}", value); }
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(const std::string& value) const { return fmt::format("\"{}\"", value); }
    std::string operator()(const UntypedText& value) const { return fmt::format("'{}'", value.text); }
  };
  return std::visit(Show{}, written);
}

}  // namespace mebots::master
