// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/node.hpp"
#include "mebots/data/object.hpp"
#include "model/system_description.hpp"

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

/// A time as a number of seconds or as a ratio such as "1/60".
ExactTime written_time(const Node& node);
/// A step: greater than 0, and long enough for internal time.
ExactTime step_time(const Node& node);
/// A time in seconds, rounded to internal time.
std::int64_t time_ns(const Node& node);
/// A time that is not negative.
std::int64_t duration_ns(const Node& node);
/// A time greater than 0 that is a multiple of the system's step: how many steps. 1 if the step is not known.
std::int64_t steps_in(const Node& node, const SystemDescription& system);

}  // namespace mebots::master::config
