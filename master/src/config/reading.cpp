// SPDX-License-Identifier: Apache-2.0
#include "reading.hpp"

#include "mebots/nearest_names.hpp"

#include <fmt/format.h>

namespace mebots::master::config {

WrittenValue written_value(const JsonNode& node) {
  const auto& value = node.value();
  if (value.is_boolean()) return value.get<bool>();
  if (value.is_number_integer() && !(value.is_number_unsigned() && value.get<std::uint64_t>() > INT64_MAX)) {
    return value.get<std::int64_t>();
  }
  if (value.is_number()) return value.get<double>();
  if (value.is_string()) return value.get<std::string>();
  node.fail("a number, true, false or a text is expected here");
}

VariableName variable_name(const JsonNode& node, const SystemDescription& system) {
  const auto text = node.string();
  if (auto name = system.split(text)) return *name;
  const auto dot = text.find('.');
  if (dot == std::string::npos || dot == 0 || dot + 1 == text.size()) {
    node.fail(fmt::format("'{}' does not name a variable; write instance.variable", text));
  }
  return {instance_name(text.substr(0, dot), node, system), text.substr(dot + 1)};
}

std::string instance_name(const std::string& name, const JsonNode& node, const SystemDescription& system) {
  if (system.find_instance(name) == nullptr) {
    node.fail(fmt::format("there is no instance '{}'. {}", name, suggest(name, system.instance_names())));
  }
  return name;
}

std::string readable_text(const JsonNode& node) {
  auto text = node.string();
  if (text.empty()) node.fail("the text is empty");
  return text;
}

std::int64_t duration_ns(const JsonNode& node) {
  const auto duration = node.nanoseconds();
  if (duration < 0) node.fail("a time cannot be negative");
  return duration;
}

}  // namespace mebots::master::config
