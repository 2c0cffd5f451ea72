// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/time_grid.hpp"
#include "mebots/input_error.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "mebots/run_options.hpp"
#include "model/fmu_kind.hpp"
#include "model/solver_description.hpp"
#include "model/step_control_description.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

/// The user's description of a system, before any FMU is opened: instances, connections, and the use of the results.
/// The description does not depend on the file format. A config is one of several formats.
namespace mebots::master {

/// A variable of an instance, written as "instance.variable". Both parts may contain dots.
struct VariableName {
  std::string instance;
  std::string variable;

  std::string text() const { return instance + "." + variable; }
  bool operator==(const VariableName&) const = default;
};

/// A value as the user wrote it.
using WrittenValue = Value;

/// Returns the value as it is shown in messages. Texts are in quotes.
std::string written_text(const WrittenValue& written);

/// A start value of a variable. `place` is its location in the file, for error messages.
struct Assignment {
  std::string variable;
  WrittenValue value;
  std::string place;
};

enum class ProcessKind {
  shared,     ///< the master's process
  own,        ///< a separate process, in which the instance cannot harm others
  sandboxed,  ///< a separate process with access to few files and nothing else (docs/master/isolation.md)
};

/// Changes to the default settings of a sandbox.
struct SandboxDescription {
  std::vector<std::string> reads;     ///< further paths that the FMU may read, absolute
  std::vector<std::string> may_lack;  ///< mechanisms that may be missing
};

/// The process of an instance, and the limits for its failures.
struct IsolationDescription {
  std::optional<ProcessKind> process;         ///< as written
  std::optional<double> deadline_s;           ///< of each call, in wall time
  std::optional<std::uint64_t> memory_bytes;  ///< of its separate process
  bool continue_without = false;              ///< if it fails, the others continue
  SandboxDescription sandbox;

  static constexpr std::uint64_t kDefaultMemoryBytes = std::uint64_t{1024} << 20;
  static constexpr std::uint64_t kNoMemoryLimit = 0;

  /// True if the instance runs in a separate process, because the config requests this, or because another option needs
  /// it.
  bool alone() const {
    return process ? *process != ProcessKind::shared : deadline_s.has_value() || memory_bytes.has_value();
  }
  bool sandboxed() const { return process == ProcessKind::sandboxed; }
};

struct InstanceDescription {
  std::string name;
  std::string fmu;                 ///< as written
  std::filesystem::path fmu_path;  ///< absolute
  std::vector<Assignment> parameters;
  std::int64_t steps = 1;           ///< its step in multiples of the system's step
  bool divide_discarded = false;    ///< split a discarded step into parts instead of ending the run
  bool pass_stop_time = false;      ///< pass the run's stop time to fmi2SetupExperiment
  bool pass_tolerance = true;       ///< pass a tolerance, if there is one, to fmi2SetupExperiment
  std::optional<double> tolerance;  ///< if absent, the FMU's default applies
  IsolationDescription isolation;
  std::optional<FmuKind> kind;              ///< as written; if absent, co-simulation if the FMU offers it
  std::optional<SolverDescription> solver;  ///< of its continuous system; if absent, that of the whole system
  std::string place;
};

/// An entry of a connection's `map`: the output's value `from` becomes the input's value `to`.
struct MappedValue {
  std::string from;
  WrittenValue to;
  std::string place;
};

/// A connection. The input is factor * x + offset, where x is the output's value in the input's unit.
struct ConnectionDescription {
  VariableName from;
  VariableName to;
  std::string place;
  double factor = 1;
  double offset = 0;
  bool convert_units = true;     ///< false: x is the output's value as it is, whatever the units
  bool narrow = false;           ///< the input's type may lack values of the output's
  bool sum = false;              ///< the input gets the sum over all connections that end at it
  std::vector<MappedValue> map;  ///< of Integers, Enumerations and Booleans; other values pass as they are
};

/// Selects the algorithm, which determines the outputs that an instance reads within a communication step.
struct AlgorithmDescription {
  std::string type = "jacobi";     ///< one of kAlgorithms
  std::vector<std::string> order;  ///< every instance once; empty = not given
};

enum class AlgorithmType { jacobi, gauss_seidel };

/// An algorithm that can be named in a config.
struct AlgorithmKind {
  AlgorithmType type;
  std::string_view name;
  bool takes_order;  ///< the config may give an order of the instances
};

/// All algorithms. engine/algorithm/registry.cpp creates them.
inline constexpr AlgorithmKind kAlgorithms[] = {
    {.type = AlgorithmType::jacobi, .name = "jacobi", .takes_order = false},
    {.type = AlgorithmType::gauss_seidel, .name = "gauss-seidel", .takes_order = true},
};

/// Returns the algorithm that the description names. If there is no algorithm with this name, throws InputError with
/// the nearest names. If the description has an order that the algorithm does not accept, also throws InputError. The
/// errors contain no place in the file.
const AlgorithmKind& find_algorithm(const AlgorithmDescription& description);

enum class Comparison { equals, above, below };

enum class Quantifier {
  none,   ///< a comparison of one variable
  all,    ///< all of the conditions hold
  any,    ///< at least one of them holds
  count,  ///< a comparison of the number of those that hold
};

/// A comparison of `variable` with `value`, or a statement about several conditions.
struct ConditionDescription {
  VariableName variable;
  Quantifier quantifier = Quantifier::none;
  std::vector<ConditionDescription> members;  ///< those of a quantifier
  Comparison comparison = Comparison::equals;
  WrittenValue value;
  std::int64_t for_ns = 0;  ///< duration for which it must hold without interruption
  bool ever = false;        ///< true once it has held at any communication point
  std::string place;
};

/// The outcome of a run for which all conditions in `when` are true at the end. An outcome without conditions always
/// applies.
struct OutcomeDescription {
  std::string outcome;
  std::vector<ConditionDescription> when;
};

enum class OverrideAction { set, offset, scale, freeze, noise, ramp, signal };

/// A CSV file with the values of variables over time.
struct SignalFileDescription {
  std::filesystem::path path;  ///< absolute
  std::string name;            ///< as written
  std::string time;            ///< name of the time column; empty = the one named time or t
  bool covers_start = false;   ///< true: an error if the run needs times before the first row; false: the first values
                               ///< apply
  bool covers_end = false;     ///< the same for times after the last row
  std::string place;
};

/// A column of a file and the input that it feeds.
struct SignalColumn {
  std::string column;
  VariableName variable;
  std::string unit;  ///< of the column, if its title has none
  std::string place;
};

/// A file whose columns are the sources of unconnected inputs.
struct InputsDescription {
  SignalFileDescription file;
  std::optional<std::vector<SignalColumn>> to;  ///< empty = columns are named after their inputs
};

/// An entry of a scenario: a change of a variable and its time.
struct OverrideDescription {
  std::string text;  ///< description for people
  VariableName variable;
  OverrideAction action = OverrideAction::set;
  WrittenValue value;                         ///< `set`
  double number = 0;                          ///< `offset`, `scale`, standard deviation of `noise`, final value of
                                              ///< `ramp`
  std::string unit;                           ///< as written, to be checked (`signal`: of the column); may be empty
  std::optional<SignalFileDescription> file;  ///< `signal`
  std::string column;                         ///< `signal`
  std::uint64_t seed = 0;                     ///< `noise`
  std::int64_t over_ns = 0;                   ///< `ramp`: duration from the original to the final value
  std::int64_t from_ns = 0;                   ///< with `when`: the condition is evaluated from this time
  std::optional<std::int64_t> until_ns;       ///< the end, exclusive
  std::optional<ConditionDescription> when;   ///< starts once, when this has held for its duration
  std::optional<std::int64_t> duration_ns;    ///< from its start
  std::string place;
};

/// A final value of one member of a group, such as one of several drones.
struct GroupMember {
  std::string name;
  VariableName variable;
  std::string place;
};

/// A final value for summary.json. Its place is `path`, a list of nested labels from the outermost to the innermost.
struct SummaryEntry {
  std::vector<std::string> path;
  VariableName variable;
  std::vector<ConditionDescription> when;  ///< if one of them does not hold at the end, the value is left out
  std::string place;
  std::vector<GroupMember> group = {};  ///< if not empty, the values, with statistics; `variable` is not used
};

/// A pattern for names: `*` matches any characters, `?` matches one.
struct RecordPattern {
  std::string pattern;
  std::string place;
};

struct RecordDescription {
  std::optional<std::vector<RecordPattern>> patterns;  ///< empty = every Real, Integer and Boolean output
  std::vector<RecordPattern> exclude;                  ///< matches are left out
  std::vector<RecordPattern> parameters;               ///< recorded once, at t = 0
  bool csv = true;                                     ///< into results.csv
  bool hdf5 = false;                                   ///< into results.h5
  bool texts = false;                                  ///< patterns, and the default of `variables`, also select texts
  bool locals = false;                                 ///< they also select local variables
  std::int64_t every_steps = 1;                        ///< a row at every such communication point
  bool step = false;                                   ///< a column with the length of the step to the row's point
};

/// Frames to write as picture files: 8-bit grey pixels in an OSMP binary.
struct PictureDescription {
  VariableName frame;            ///< name of the binary, without `.base.lo`
  VariableName id;               ///< Integer that changes with every new frame
  std::int32_t width = 0;        ///< pixels per row
  std::int64_t interval_ns = 0;  ///< minimum time between pictures; 0 = every frame
  std::string place;
};

/// A line, band or lane in a panel of the run's page.
struct CurveDescription {
  VariableName variable;
  bool rate = false;  ///< show the mean rate of change from row to row: the power for an energy
  std::string label;  ///< for people; empty = the name of the variable
  std::string place;
};

enum class PanelKind {
  lines,  ///< overlaid curves
  stack,  ///< stacked areas: parts of a whole
  lanes,  ///< one lane per curve: states, and shares of the time as shades
};

struct PanelDescription {
  std::string title;
  PanelKind kind = PanelKind::lines;
  std::vector<CurveDescription> curves;
};

/// Contents of the page of a run. They do not affect computed or recorded values.
struct ViewDescription {
  std::optional<VariableName> scene;  ///< String, read once at t = 0: a scene in the format of docs/seeing.md
  std::string scene_place;
  std::vector<PanelDescription> panels;
  std::vector<std::string> marks;  ///< instances whose messages are marked on the timeline
};

/// A power bond: two connections whose product is the power that is transferred between two instances, such as force
/// and velocity.
struct BondDescription {
  std::string name;
  VariableName effort;  ///< the connected input for the effort
  VariableName flow;    ///< the connected input for the flow, of the instance that provides the effort
  double limit = 0.01;  ///< maximum energy that the coupling may create or lose, relative to the transferred energy
  std::string place;
};

/// Quantities of the coupling report, and the limits of its warnings.
struct CouplingDescription {
  std::optional<double> input_limit;  ///< maximum deviation of an input (root mean square), relative to its range
  std::vector<BondDescription> bonds;
};

/// The log categories of an instance whose ordinary messages are shown; "*" means all.
struct LogDescription {
  std::string instance;
  std::vector<std::string> categories;
};

/// The log categories that are shown if the config has no setting for an instance.
inline constexpr std::string_view kDefaultLogCategories[] = {"console", "events", "faults", "observe"};

/// The value of SystemDescription::threads that means "automatic": as many threads as the machine can run at the same
/// time.
inline constexpr unsigned kAutomaticThreads = 0;

/// Finds instances by name. Builds an index of the names at the first search. The names must not change afterwards.
class InstanceIndex {
 public:
  std::optional<std::size_t> find(const std::vector<InstanceDescription>& instances, std::string_view name) const;

 private:
  struct Hash {
    using is_transparent = void;
    std::size_t operator()(std::string_view name) const { return std::hash<std::string_view>()(name); }
  };

  mutable std::unordered_map<std::string, std::size_t, Hash, std::equal_to<>> places_;
  mutable std::size_t known_ = 0;
};

struct SystemDescription {
  std::filesystem::path file;  ///< the config, FMU or SSP
  std::string name;            ///< name of the file without extension
  std::string source;          ///< content, for the hash of the inputs
  ExactTime step;              ///< communication step
  std::int64_t start_time_ns = 0;
  std::int64_t stop_time_ns = 0;  ///< internal time of a communication point, see TimeGrid
  bool single_fmu = false;        ///< describes a single FMU: names of variables need no instance
  std::vector<InstanceDescription> instances;
  std::vector<ConnectionDescription> connections;
  AlgorithmDescription algorithm;
  std::optional<StepControlDescription> step_control;  ///< nothing = every communication step is `step`
  SolverDescription solver;                            ///< of continuous systems without one of their own
  std::vector<ConditionDescription> stop_when;         ///< any one of them ends the run
  std::vector<OutcomeDescription> outcomes;            ///< the first that holds is the outcome
  std::vector<InputsDescription> inputs;               ///< sources of free inputs
  std::vector<OverrideDescription> scenario;           ///< overrides of one variable act in this order
  std::vector<SummaryEntry> summary;
  RecordDescription record;
  std::vector<PictureDescription> pictures;
  ViewDescription view;
  std::optional<CouplingDescription> coupling;  ///< empty = no report
  std::vector<LogDescription> log;
  bool draws_calibration = false;    ///< "uncertainty": "calibration"
  unsigned threads = 1;              ///< maximum number of threads that step slaves, if that is faster
  std::vector<std::string> notices;  ///< of the reader, for the user
  std::shared_ptr<const modeldesc::TemporaryFolder> unpacked;  ///< the folder of an SSP's FMUs

  InstanceIndex index;

  TimeGrid grid() const { return {start_time_ns, step}; }
  /// Returns the length of `count` steps.
  ExactTime length_of(std::int64_t count) const;
  /// Returns the step of an instance.
  ExactTime step_of(const InstanceDescription& instance) const;
  /// Returns the index of an instance in `instances`. Like all searches by name, it must not be called by two threads
  /// at the same time.
  std::optional<std::size_t> index_of(std::string_view instance_name) const;
  const InstanceDescription* find_instance(std::string_view instance_name) const;
  std::vector<std::string> instance_names() const;
  /// Splits "instance.variable" by the names of the instances; empty if no instance matches. In the system of a single
  /// FMU, a text that matches no instance is a variable of that FMU.
  std::optional<VariableName> split(std::string_view text) const;
};

/// Splits "instance.variable". If no instance matches, the instance is the text before the first dot. Throws InputError
/// if one part is missing.
VariableName parse_variable(const SystemDescription& system, std::string_view text, const std::string& place);

/// A setting whose instance was found.
struct LocatedSetting {
  InstanceDescription* instance = nullptr;
  Assignment assignment;
};

/// Finds the instance of a setting. Throws InputError with the nearest names if the system has no such instance.
LocatedSetting locate(SystemDescription& system, const Setting& setting);

/// Returns the reason why a run cannot end at this time; empty if it can. The duration of a run must be a multiple of
/// the steps of all instances.
std::optional<std::string> stop_time_problem(const SystemDescription& system, std::int64_t stop_time_ns);

/// Sets the end of the run, as `--stop-time` does. Throws InputError if stop_time_problem() returns a reason.
void set_stop_time(SystemDescription& system, std::int64_t stop_time_ns, const std::string& place);

}  // namespace mebots::master
