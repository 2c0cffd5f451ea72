// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/node.hpp"
#include "mebots/data/object.hpp"
#include "model/system_description.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>
#include <string>

/// Readers of the sections of a config. The table in config_reader.cpp defines their order: a reader may use results of
/// earlier readers in `system`. Readers report errors to the node's document, and throw data::Mistakes if they cannot
/// continue.
namespace mebots::master::config {

void read_text(const data::Node& node, SystemDescription& system);
void read_step(const data::Node& node, SystemDescription& system);
/// Does nothing, because expand_repeats() has already read the groups.
void read_groups(const data::Node& node, SystemDescription& system);
void read_instances(const data::Node& node, SystemDescription& system);
void read_start_time(const data::Node& node, SystemDescription& system);
void read_stop_time(const data::Node& node, SystemDescription& system);
void read_connections(const data::Node& node, SystemDescription& system);
void read_scenario(const data::Node& node, SystemDescription& system);
void read_inputs(const data::Node& node, SystemDescription& system);
/// Reads a whole scenario file: `text` and `scenario`. Paths in it are relative to `folder`.
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

/// Readers of values that several sections share. They throw data::Mistakes with the value's place. An unknown name is
/// reported without an exception, because 100,000 exceptions would take longer than reading the file.
namespace mebots::master::config {

using data::Node;
using data::Object;

/// Reads a number, true, false or a text.
WrittenValue written_value(const Node& node);

/// Reads "instance.variable". Reports a mistake at the node if the system has no such instance.
VariableName variable_name(const Node& node, const SystemDescription& system);
inline auto variable_of(const SystemDescription& system) {
  return [&system](const Node& node) { return variable_name(node, system); };
}

/// Returns the instance's name. Reports a mistake at the node if the system has no such instance.
std::string instance_name(const std::string& name, const Node& node, const SystemDescription& system);

/// Reads the keys of a signal file, which `inputs` and the entries of a scenario share. A path is relative to `folder`.
SignalFileDescription read_signal_file(Object& object, const std::filesystem::path& folder);
inline constexpr std::string_view kSignalFileKeys[] = {"file", "time", "before", "after"};

/// Reads a time as a number of seconds or as a ratio such as "1/60".
ExactTime written_time(const Node& node);
/// Reads a step. A step must be greater than 0, and a ratio must be at least kShortestRatioNs.
ExactTime step_time(const Node& node);
/// Reads a time in seconds, rounded to nanoseconds.
std::int64_t time_ns(const Node& node);
/// Reads a time that is not negative.
std::int64_t duration_ns(const Node& node);
/// Reads a time greater than 0 that is a multiple of the system's step. Returns the number of steps; 1 if the system's
/// step is not known.
std::int64_t steps_in(const Node& node, const SystemDescription& system);

/// Reads the settings of the solver of continuous systems.
SolverDescription solver_description(const Node& node);

/// Reads a further key that a condition may have.
using ReadMore = void (*)(Object& object, ConditionDescription& condition);

/// Reads a comparison of a variable, or a quantifier with conditions. Calls `read_more` for each of these conditions.
ConditionDescription read_condition(
    Object& object, const SystemDescription& system, ReadMore read_more = [](Object&, ConditionDescription&) {});

/// Reads a condition with an optional duration, `for`.
ConditionDescription read_lasting_condition(const Node& node, const SystemDescription& system);

}  // namespace mebots::master::config

/// Entries that a config describes once for many copies: {"motors[{i}]": {"repeat": {"i": [1, 16]}, "fmu": ...}}. The
/// copies replace the entry before the sections are read. `groups` gives names to indexes that several entries use.
namespace mebots::master::config {

inline constexpr const char* kRepeat = "repeat";
inline constexpr const char* kGroups = "groups";
inline constexpr const char* kInstances = "instances";

/// The inputs and results of an expansion.
struct Repeats {
  std::filesystem::path folder;               ///< of the config
  std::map<std::string, std::string> places;  ///< by JSON pointers of the expanded config; for data::JsonDocument
  std::string source;                         ///< texts of the tables that were read
};

/// Returns true if the config has groups, or an instance or an element of a list with `repeat`.
bool has_repeats(const data::Node& root);

/// Replaces entries with `repeat` by their copies, and removes the groups. `config` is the JSON of `root`. `file` is
/// the file's name, with which the places of its nodes begin. Reports mistakes to the node's document.
void expand_repeats(const data::Node& root, nlohmann::ordered_json& config, const std::string& file, Repeats& repeats);

}  // namespace mebots::master::config
