// SPDX-License-Identifier: Apache-2.0
#include "sections.hpp"

#include "base/time.hpp"
#include "mebots/nearest_names.hpp"

#include <fmt/format.h>

#include <limits>

namespace mebots::master::config {

WrittenValue written_value(const Node& node) {
  constexpr auto kLargest = std::numeric_limits<std::int64_t>::max();
  switch (node.kind()) {
    case data::Kind::boolean:
      return node.flag();
    case data::Kind::whole_number:
      if (!node.is_integer_literal()) return node.number();
      if (node.number() > 0 && node.natural_number() > static_cast<std::uint64_t>(kLargest))
        return UntypedText{std::to_string(node.natural_number())};
      return node.whole_number(std::numeric_limits<std::int64_t>::min(), kLargest);
    case data::Kind::number:
      return node.number();
    case data::Kind::text:
      return node.text();
    default:
      node.fail(ErrorCode::wrong_type,
                fmt::format("a number, true, false or a text is expected here, not {}", node.shown()));
  }
}

VariableName variable_name(const Node& node, const SystemDescription& system) {
  const auto text = node.text();
  if (auto name = system.split(text)) return *name;
  const auto dot = text.find('.');
  if (dot == std::string::npos || dot == 0 || dot + 1 == text.size()) {
    node.complain(ErrorCode::invalid_value,
                  fmt::format("'{}' does not name a variable; write instance.variable", text));
    return {};
  }
  const auto instance = text.substr(0, dot);
  // If a scenario is checked without a config, the instances are not known.
  if (!system.instances.empty()) static_cast<void>(instance_name(instance, node, system));
  return {instance, text.substr(dot + 1)};
}

std::string instance_name(const std::string& name, const Node& node, const SystemDescription& system) {
  if (system.find_instance(name) != nullptr) return name;
  // After this number of errors, no similar name is searched, because searching 100,000 names is slow and messages show
  // no more errors.
  constexpr std::size_t kAnswered = 20;
  auto what = fmt::format("there is no instance '{}'", name);
  if (node.noted() < kAnswered) what += ". " + suggest(name, system.instance_names());
  node.complain(ErrorCode::unknown_name, what);
  return name;
}

ExactTime written_time(const Node& node) {
  const bool is_text = node.kind() == data::Kind::text;
  const auto time = is_text ? read_ratio(node.text()) : exact_time(node.number());
  if (time) return *time;
  if (is_text) {
    node.fail(ErrorCode::invalid_value,
              fmt::format("{} is not a ratio of two whole numbers; write a number of seconds, or a ratio such as "
                          "\"1/60\" with a denominator up to 1e9",
                          node.shown()));
  }
  node.fail(
      ErrorCode::value_out_of_range,
      fmt::format("{} s is neither a whole number of nanoseconds nor, within 1e-15, a ratio with a denominator up "
                  "to {} (or longer than {} s); give a time such as 0.002, or a ratio such as \"1/60\"",
                  node.shown(), kLargestDenominator, kLongestTimeS));
}

ExactTime step_time(const Node& node) {
  const auto step = written_time(node);
  if (step.numerator <= 0) node.fail(ErrorCode::value_out_of_range, "the step must be greater than 0 s");
  if (!step.is_whole_nanoseconds() && to_nanoseconds(step) < TimeGrid::kShortestRatioNs) {
    node.fail(ErrorCode::value_out_of_range, fmt::format("the step {} s is too short: a ratio must be at least {} ns",
                                                         node.shown(), TimeGrid::kShortestRatioNs));
  }
  return step;
}

std::int64_t time_ns(const Node& node) {
  return to_nanoseconds(written_time(node));
}

std::int64_t duration_ns(const Node& node) {
  const auto duration = time_ns(node);
  if (duration < 0) node.fail(ErrorCode::value_out_of_range, "a time cannot be negative");
  return duration;
}

std::int64_t steps_in(const Node& node, const SystemDescription& system) {
  const auto time = written_time(node);
  if (time.numerator <= 0) node.fail(ErrorCode::value_out_of_range, "this must be a time greater than 0 s");
  if (system.step.numerator <= 0) return 1;
  const auto numerator = WideInteger{time.numerator} * system.step.denominator;
  const auto denominator = WideInteger{time.denominator} * system.step.numerator;
  if (numerator % denominator != 0) {
    node.fail(ErrorCode::invalid_value,
              fmt::format("{} s is not a multiple of the system's step {} s", time_text(time), time_text(system.step)));
  }
  return static_cast<std::int64_t>(numerator / denominator);
}

}  // namespace mebots::master::config
