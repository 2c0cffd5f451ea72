// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/json_node.hpp"
#include "config/system_description.hpp"

#include <string>

/// Values that several sections of a config have in common. All throw InputError with the value's place.
namespace mebots::master::config {

/// A number, true, false or a text.
WrittenValue written_value(const JsonNode& node);

/// "instance.variable" of an instance that the system has.
VariableName variable_name(const JsonNode& node, const SystemDescription& system);

/// The name of an instance that the system has.
std::string instance_name(const std::string& name, const JsonNode& node, const SystemDescription& system);

/// A text that is not empty.
std::string readable_text(const JsonNode& node);

/// A time that is not negative.
std::int64_t duration_ns(const JsonNode& node);

}  // namespace mebots::master::config
