// SPDX-License-Identifier: Apache-2.0
#include "reading.hpp"

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
      if (node.is_integer_literal() && node.number() < static_cast<double>(kLargest)) {
        return node.whole_number(std::numeric_limits<std::int64_t>::min(), kLargest);
      }
      return node.number();
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
  // A scenario that is looked at alone: nobody knows what its instances will be.
  if (!system.instances.empty()) static_cast<void>(instance_name(instance, node, system));
  return {instance, text.substr(dot + 1)};
}

std::string instance_name(const std::string& name, const Node& node, const SystemDescription& system) {
  if (system.find_instance(name) != nullptr) return name;
  // To look for the nearest of 100,000 names takes a while: not for mistakes that nobody gets to see.
  constexpr std::size_t kAnswered = 20;
  auto what = fmt::format("there is no instance '{}'", name);
  if (node.noted() < kAnswered) what += ". " + suggest(name, system.instance_names());
  node.complain(ErrorCode::unknown_name, what);
  return name;
}

std::int64_t time_ns(const Node& node) {
  const auto time = to_nanoseconds(node.number());
  if (!time) {
    node.fail(ErrorCode::value_out_of_range,
              fmt::format("{} s is not a whole number of nanoseconds (or longer than {} s); give a time such as 0.002",
                          node.shown(), kLongestTimeS));
  }
  return *time;
}

std::int64_t duration_ns(const Node& node) {
  const auto duration = time_ns(node);
  if (duration < 0) node.fail(ErrorCode::value_out_of_range, "a time cannot be negative");
  return duration;
}

std::int64_t multiple_of_step_ns(const Node& node, const SystemDescription& system) {
  const auto time = time_ns(node);
  if (time <= 0) node.fail(ErrorCode::value_out_of_range, "this must be a time greater than 0 s");
  if (system.step_ns > 0 && time % system.step_ns != 0) {
    node.fail(ErrorCode::invalid_value, fmt::format("{} s is not a multiple of the system's step {} s",
                                                    to_seconds(time), to_seconds(system.step_ns)));
  }
  return time;
}

}  // namespace mebots::master::config
