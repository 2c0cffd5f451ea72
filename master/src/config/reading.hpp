// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/system_description.hpp"
#include "mebots/data/node.hpp"
#include "mebots/data/object.hpp"

#include <string>

/// Values that several sections of a config have in common. All throw data::Mistakes with the value's place, but for
/// names: a file may have 100,000 unknown ones, and to throw each would take longer than to read it.
namespace mebots::master::config {

using data::Node;
using data::Object;

/// A number, true, false or a text.
WrittenValue written_value(const Node& node);

/// "instance.variable" of an instance that the system has. A mistake is noted at the node.
VariableName variable_name(const Node& node, const SystemDescription& system);
inline auto variable_of(const SystemDescription& system) {
  return [&system](const Node& node) { return variable_name(node, system); };
}

/// The name of an instance that the system has. A mistake is noted at the node.
std::string instance_name(const std::string& name, const Node& node, const SystemDescription& system);

/// Reads the keys of a file of signals, which `inputs` and an entry of a scenario share. A path is relative to
/// `folder`.
SignalFileDescription read_signal_file(Object& object, const std::filesystem::path& folder);
inline constexpr std::string_view kSignalFileKeys[] = {"file", "time", "before", "after"};

/// A time in seconds that is a whole number of nanoseconds.
std::int64_t time_ns(const Node& node);
/// A time that is not negative.
std::int64_t duration_ns(const Node& node);
/// A time greater than 0 that is a multiple of the system's step, where that is known.
std::int64_t multiple_of_step_ns(const Node& node, const SystemDescription& system);

}  // namespace mebots::master::config
