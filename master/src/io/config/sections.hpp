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
/// earlier readers. config_reader.cpp defines the order. Readers report mistakes to the document of the node. They
/// throw data::Mistakes if they cannot continue.
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
/// Reads `text` and `scenario` of a scenario file. Paths in the file are relative to `folder`.
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

/// Declares readers for values that occur in several sections. They throw data::Mistakes with the place of the value.
/// Unknown names are reported without an exception, because 100,000 exceptions take longer than reading the file.
namespace mebots::master::config {

using data::Node;
using data::Object;

WrittenValue written_value(const Node& node);

/// Reads a name such as "instance.variable". Reports a mistake if the system has no such instance.
VariableName variable_name(const Node& node, const SystemDescription& system);
inline auto variable_of(const SystemDescription& system) {
  return [&system](const Node& node) { return variable_name(node, system); };
}

/// Returns `name`. Reports a mistake at `node` if the system has no such instance.
std::string instance_name(const std::string& name, const Node& node, const SystemDescription& system);

/// Reads the keys of a signal file in `inputs` or in a scenario. Its path is relative to `folder`.
SignalFileDescription read_signal_file(Object& object, const std::filesystem::path& folder);
inline constexpr std::string_view kSignalFileKeys[] = {"file", "time", "before", "after"};

/// Reads a time: a number of seconds, or a ratio such as "1/60".
ExactTime written_time(const Node& node);
/// Reads a step, which must be positive. A ratio must be at least kShortestRatioNs.
ExactTime step_time(const Node& node);
/// Reads a time in seconds and rounds it to nanoseconds.
std::int64_t time_ns(const Node& node);
/// Reads a time like time_ns(). It must not be negative.
std::int64_t duration_ns(const Node& node);
/// Reads a positive time that must be a multiple of the system's step. Returns the number of steps, or 1 if the
/// system's step is unknown.
std::int64_t steps_in(const Node& node, const SystemDescription& system);

SolverDescription solver_description(const Node& node);

using ReadMore = void (*)(Object& object, ConditionDescription& condition);

/// Reads a comparison, or a quantifier and its conditions. Calls `read_more` for each condition.
ConditionDescription read_condition(
    Object& object, const SystemDescription& system, ReadMore read_more = [](Object&, ConditionDescription&) {});

ConditionDescription read_lasting_condition(const Node& node, const SystemDescription& system);

}  // namespace mebots::master::config

/// Replaces entries with `repeat` by their copies before the sections are read. For example, {"motors[{i}]": {"repeat":
/// {"i": [1, 16]}, "fmu": ...}} becomes the instances motors[1] to motors[16]. The section `groups` names ranges of
/// indexes that several entries use.
namespace mebots::master::config {

inline constexpr const char* kRepeat = "repeat";
inline constexpr const char* kGroups = "groups";
inline constexpr const char* kInstances = "instances";

struct Repeats {
  std::filesystem::path folder;  ///< folder of the config
  /// Places of values in the expanded config for data::JsonDocument; the keys are JSON pointers.
  std::map<std::string, std::string> places;
  std::string source;  ///< the texts of all tables that were read
};

/// True if the config contains groups, or an instance or list element with `repeat`.
bool has_repeats(const data::Node& root);

/// Replaces entries with `repeat` by their copies, and removes the groups. `config` must be the JSON of `root`. The
/// places of nodes begin with `file`. Reports mistakes to the document of the node.
void expand_repeats(const data::Node& root, nlohmann::ordered_json& config, const std::string& file, Repeats& repeats);

}  // namespace mebots::master::config
