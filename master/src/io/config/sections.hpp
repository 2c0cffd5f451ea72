// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/node.hpp"
#include "mebots/data/object.hpp"
#include "model/system_description.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <string>

/// Declares a reader for each section of a config. A reader stores its section in `system` and may use the results of
/// earlier readers. The table in config_reader.cpp defines the order of the readers. Readers report mistakes to the
/// document of the node. They throw data::Mistakes if they cannot continue.
namespace mebots::master::config {

void read_text(const data::Node& node, SystemDescription& system);
void read_step(const data::Node& node, SystemDescription& system);
/// Has no effect, because expand_repeats() has already read the groups.
void read_groups(const data::Node& node, SystemDescription& system);
void read_instances(const data::Node& node, SystemDescription& system);
void read_start_time(const data::Node& node, SystemDescription& system);
void read_stop_time(const data::Node& node, SystemDescription& system);
void read_connections(const data::Node& node, SystemDescription& system);
void read_scenario(const data::Node& node, SystemDescription& system);
void read_inputs(const data::Node& node, SystemDescription& system);
/// Reads the keys `text` and `scenario` of a scenario file. Paths in the file are relative to `folder`.
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

/// Declares readers of values that occur in several sections. They throw data::Mistakes with the place of the value. An
/// unknown name is reported without an exception, because 100,000 exceptions would take longer than reading the file.
namespace mebots::master::config {

using data::Node;
using data::Object;

/// Reads a value that is a number, true, false or a text.
WrittenValue written_value(const Node& node);

/// Reads a name of the form "instance.variable". Reports a mistake at the node if the system has no such instance.
VariableName variable_name(const Node& node, const SystemDescription& system);
inline auto variable_of(const SystemDescription& system) {
  return [&system](const Node& node) { return variable_name(node, system); };
}

/// Returns `name`. Reports a mistake at the node if the system has no instance of this name.
std::string instance_name(const std::string& name, const Node& node, const SystemDescription& system);

/// Reads the keys of a signal file, which can occur in `inputs` and in entries of a scenario. Its path is relative to
/// `folder`.
SignalFileDescription read_signal_file(Object& object, const std::filesystem::path& folder);
inline constexpr std::string_view kSignalFileKeys[] = {"file", "time", "before", "after"};

/// Reads a time as a number of seconds or as a ratio such as "1/60".
ExactTime written_time(const Node& node);
/// Reads a step. It must be greater than 0; a ratio must be at least kShortestRatioNs.
ExactTime step_time(const Node& node);
/// Reads a time in seconds. Returns it rounded to nanoseconds.
std::int64_t time_ns(const Node& node);
/// Reads a time as time_ns() does. It must not be negative.
std::int64_t duration_ns(const Node& node);
/// Reads a time greater than 0 that must be a multiple of the system's step. Returns the number of steps, or 1 if the
/// system's step is unknown.
std::int64_t steps_in(const Node& node, const SystemDescription& system);

/// Reads the settings of the solver for continuous systems.
SolverDescription solver_description(const Node& node);

/// A function that reads additional keys of a condition.
using ReadMore = void (*)(Object& object, ConditionDescription& condition);

/// Reads a comparison of a variable, or a quantifier and its conditions. Calls `read_more` for each condition.
ConditionDescription read_condition(
    Object& object, const SystemDescription& system, ReadMore read_more = [](Object&, ConditionDescription&) {});

/// Reads a condition that may have a duration, `for`.
ConditionDescription read_lasting_condition(const Node& node, const SystemDescription& system);

}  // namespace mebots::master::config

/// Replaces entries that describe many copies once, such as {"motors[{i}]": {"repeat": {"i": [1, 16]}, "fmu": ...}}.
/// This happens before the sections are read. `groups` gives names to indexes that several entries use.
namespace mebots::master::config {

inline constexpr const char* kRepeat = "repeat";
inline constexpr const char* kGroups = "groups";
inline constexpr const char* kInstances = "instances";

/// Contains the input and the results of expand_repeats().
struct Repeats {
  std::filesystem::path folder;  ///< folder of the config
  /// Maps JSON pointers in the expanded config to their places, for data::JsonDocument.
  std::map<std::string, std::string> places;
  std::string source;  ///< the texts of all tables that were read
};

/// Returns true if the config contains groups, or an instance or list element that has the key `repeat`.
bool has_repeats(const data::Node& root);

/// Replaces entries that have `repeat` by their copies, and removes the groups. `config` must be the JSON of `root`.
/// `file` is the name of the file, with which the places of its nodes begin. Reports mistakes to the document of the
/// node.
void expand_repeats(const data::Node& root, nlohmann::ordered_json& config, const std::string& file, Repeats& repeats);

}  // namespace mebots::master::config
