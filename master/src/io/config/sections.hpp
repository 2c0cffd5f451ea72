// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/node.hpp"
#include "mebots/data/object.hpp"
#include "model/system_description.hpp"

#include <string>

/// Readers of the sections of a config, one each. The table in config_reader.cpp gives their order: a reader may use
/// what the earlier ones stored in `system`. They report errors to the node's document, and throw data::Mistakes if
/// they cannot continue.
namespace mebots::master::config {

void read_text(const data::Node& node, SystemDescription& system);
void read_step(const data::Node& node, SystemDescription& system);
void read_instances(const data::Node& node, SystemDescription& system);
void read_start_time(const data::Node& node, SystemDescription& system);
void read_stop_time(const data::Node& node, SystemDescription& system);
void read_connections(const data::Node& node, SystemDescription& system);
void read_scenario(const data::Node& node, SystemDescription& system);
void read_inputs(const data::Node& node, SystemDescription& system);
/// The whole of a scenario file: `text` and `scenario`. Paths in it are relative to `folder`.
void read_scenario_file(const data::Node& root, SystemDescription& system, const std::filesystem::path& folder);
void read_algorithm(const data::Node& node, SystemDescription& system);
void read_solver(const data::Node& node, SystemDescription& system);
void read_step_control(const data::Node& node, SystemDescription& system);
void read_stop_when(const data::Node& node, SystemDescription& system);
void read_outcomes(const data::Node& node, SystemDescription& system);
void read_summary(const data::Node& node, SystemDescription& system);
void read_record(const data::Node& node, SystemDescription& system);
void read_pictures(const data::Node& node, SystemDescription& system);
void read_view(const data::Node& node, SystemDescription& system);
void read_log(const data::Node& node, SystemDescription& system);
void read_coupling(const data::Node& node, SystemDescription& system);
void read_uncertainty(const data::Node& node, SystemDescription& system);
void read_threads(const data::Node& node, SystemDescription& system);

}  // namespace mebots::master::config

/// Readers of values that several sections share. All throw data::Mistakes with the value's place. Unknown names are
/// only noted: a file may have 100,000 of them, and to throw each would take longer than to read the file.
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

/// The settings of the solver of continuous systems.
SolverDescription solver_description(const Node& node);

/// The variable and the one comparison of a condition.
ConditionDescription read_condition(Object& object, const SystemDescription& system);

/// A condition that may have to last: `for`.
ConditionDescription read_lasting_condition(const Node& node, const SystemDescription& system);

}  // namespace mebots::master::config
