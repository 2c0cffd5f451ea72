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

/// Declares the user's description of a system, before any FMU is opened: instances, connections, and how the results
/// are used. The description does not depend on the file format; a config is one of several formats.
namespace mebots::master {

/// Identifies a variable of an instance. Written as "instance.variable"; both parts may contain dots.
struct VariableName {
  std::string instance;
  std::string variable;

  std::string text() const { return instance + "." + variable; }
  bool operator==(const VariableName&) const = default;
};

/// A value as the user wrote it.
using WrittenValue = Value;

/// Returns the value as messages show it. Texts are in quotes.
std::string written_text(const WrittenValue& written);

/// A start value of a variable. `place` is its location in the file; error messages quote it.
struct Assignment {
  std::string variable;
  WrittenValue value;
  std::string place;
};

enum class ProcessKind {
  shared,     ///< the process of the master
  own,        ///< a separate process, in which the instance cannot harm others
  sandboxed,  ///< a separate process that can access only a few files (docs/master/isolation.md)
};

/// Changes the default settings of a sandbox.
struct SandboxDescription {
  std::vector<std::string> reads;     ///< paths that the FMU may read in addition; absolute
  std::vector<std::string> may_lack;  ///< names of mechanisms that may be missing
};

/// States in which process an instance runs, and the limits at which it counts as failed.
struct IsolationDescription {
  std::optional<ProcessKind> process;         ///< as written by the user
  std::optional<double> deadline_s;           ///< maximum wall time of each call
  std::optional<std::uint64_t> memory_bytes;  ///< maximum memory of the instance's separate process
  bool continue_without = false;              ///< true: if the instance fails, the other instances continue
  SandboxDescription sandbox;

  static constexpr std::uint64_t kDefaultMemoryBytes = std::uint64_t{1024} << 20;
  static constexpr std::uint64_t kNoMemoryLimit = 0;

  /// True if the instance runs in a separate process, because the config requests it or because another option requires
  /// it.
  bool alone() const {
    return process ? *process != ProcessKind::shared : deadline_s.has_value() || memory_bytes.has_value();
  }
  bool sandboxed() const { return process == ProcessKind::sandboxed; }
};

struct InstanceDescription {
  std::string name;
  std::string fmu;                 ///< name or path, as written by the user
  std::filesystem::path fmu_path;  ///< absolute path
  std::vector<Assignment> parameters;
  std::int64_t steps = 1;           ///< length of its step, as a multiple of the system's step
  bool divide_discarded = false;    ///< true: a discarded step is divided into parts and does not end the run
  bool pass_stop_time = false;      ///< true: fmi2SetupExperiment receives the stop time of the run
  bool pass_tolerance = true;       ///< true: fmi2SetupExperiment receives the tolerance, if there is one
  std::optional<double> tolerance;  ///< default: that of the FMU
  IsolationDescription isolation;
  std::optional<FmuKind> kind;              ///< as written; default: co-simulation if the FMU offers it
  std::optional<SolverDescription> solver;  ///< solver of its continuous system; default: that of the whole system
  std::string place;
};

/// An entry of a connection's `map`: if the output has the value `from`, the input is set to `to`.
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
  bool convert_units = true;  ///< false: x is the output's value without conversion, whatever its unit
  bool narrow = false;        ///< true: the input's type may be unable to represent some values of the output's type
  bool sum = false;           ///< true: the input is the sum of all connections that end at it
  /// For Integers, Enumerations and Booleans; values without an entry are passed on unchanged.
  std::vector<MappedValue> map;
};

/// Selects the algorithm, which determines from which time an instance reads its inputs within a communication step.
struct AlgorithmDescription {
  std::string type = "jacobi";     ///< name of one of kAlgorithms
  std::vector<std::string> order;  ///< contains every instance once; empty if the config gives no order
};

enum class AlgorithmType { jacobi, gauss_seidel };

/// Describes an algorithm that can be named in a config.
struct AlgorithmKind {
  AlgorithmType type;
  std::string_view name;
  bool takes_order;  ///< true if the config may give an order of the instances
};

/// All algorithms. engine/algorithm/registry.cpp creates them.
inline constexpr AlgorithmKind kAlgorithms[] = {
    {.type = AlgorithmType::jacobi, .name = "jacobi", .takes_order = false},
    {.type = AlgorithmType::gauss_seidel, .name = "gauss-seidel", .takes_order = true},
};

/// Returns the algorithm that the description names. Throws InputError with similar names if no algorithm has this
/// name. Also throws InputError if the description contains an order and the algorithm does not accept one. The errors
/// contain no place in the file.
const AlgorithmKind& find_algorithm(const AlgorithmDescription& description);

enum class Comparison { equals, above, below };

enum class Quantifier {
  none,   ///< compares one variable
  all,    ///< true if all members are true
  any,    ///< true if at least one member is true
  count,  ///< compares the number of members that are true
};

/// A comparison of `variable` with `value`, or a statement about the conditions in `members`.
struct ConditionDescription {
  VariableName variable;
  Quantifier quantifier = Quantifier::none;
  std::vector<ConditionDescription> members;  ///< conditions to which the quantifier applies
  Comparison comparison = Comparison::equals;
  WrittenValue value;
  std::int64_t for_ns = 0;  ///< duration for which the condition must be true without interruption
  bool ever = false;        ///< true: the condition stays true once it was true at a communication point
  std::string place;
};

/// An outcome of a run. It applies if all conditions in `when` are true at the end. An outcome without conditions
/// always applies.
struct OutcomeDescription {
  std::string outcome;
  std::vector<ConditionDescription> when;
};

enum class OverrideAction { set, offset, scale, freeze, noise, ramp, signal };

/// A CSV file that contains the values of variables over time.
struct SignalFileDescription {
  std::filesystem::path path;  ///< absolute path
  std::string name;            ///< path as written by the user
  std::string time;            ///< name of the time column; empty: the column that is named time or t
  /// True: times before the first row are an error; false: the first values apply before the first row.
  bool covers_start = false;
  bool covers_end = false;  ///< the same for times after the last row
  std::string place;
};

/// A column of a file, and the input that receives its values.
struct SignalColumn {
  std::string column;
  VariableName variable;
  std::string unit;  ///< unit of the column, used if its title contains none
  std::string place;
};

/// A file whose columns are the sources of unconnected inputs.
struct InputsDescription {
  SignalFileDescription file;
  std::optional<std::vector<SignalColumn>> to;  ///< nullopt: each column has the name of its input
};

/// An entry of a scenario: it states how and when a variable is changed.
struct OverrideDescription {
  std::string text;  ///< describes the entry for readers
  VariableName variable;
  OverrideAction action = OverrideAction::set;
  WrittenValue value;  ///< for `set`
  /// The offset for `offset`, the factor for `scale`, the standard deviation for `noise`, the final value for `ramp`.
  double number = 0;
  std::string unit;  ///< unit as written, which is checked; for `signal`, the unit of the column; may be empty
  std::optional<SignalFileDescription> file;  ///< for `signal`
  std::string column;                         ///< for `signal`
  std::uint64_t seed = 0;                     ///< for `noise`
  std::int64_t over_ns = 0;                   ///< for `ramp`: time from the original to the final value
  std::int64_t from_ns = 0;  ///< start of the override; if `when` is set, the time from which it is evaluated
  std::optional<std::int64_t> until_ns;  ///< end of the override, which is not included
  /// Starts the override once, after this condition has been true for its duration.
  std::optional<ConditionDescription> when;
  std::optional<std::int64_t> duration_ns;  ///< duration of the override after its start
  std::string place;
};

/// The final value of one member of a group, for example of one of several drones.
struct GroupMember {
  std::string name;
  VariableName variable;
  std::string place;
};

/// A final value that is written to summary.json at `path`, a list of nested keys; the outermost key comes first.
struct SummaryEntry {
  std::vector<std::string> path;
  VariableName variable;
  std::vector<ConditionDescription> when;  ///< if one of these conditions is false at the end, the value is left out
  std::string place;
  /// If not empty, the values of these members are written with their statistics, and `variable` is not used.
  std::vector<GroupMember> group = {};
};

/// A pattern that selects variables by name: `*` matches any characters, `?` matches one character.
struct RecordPattern {
  std::string pattern;
  std::string place;
};

struct RecordDescription {
  std::optional<std::vector<RecordPattern>> patterns;  ///< nullopt: every Real, Integer and Boolean output is recorded
  std::vector<RecordPattern> exclude;                  ///< variables that match are not recorded
  std::vector<RecordPattern> parameters;               ///< variables that are recorded once, at t = 0
  bool csv = true;                                     ///< true: rows are written to results.csv
  bool hdf5 = false;                                   ///< true: rows are written to results.h5
  bool texts = false;                                  ///< true: `patterns` and its default also select texts
  bool locals = false;                                 ///< true: `patterns` and its default also select local variables
  std::int64_t every_steps = 1;                        ///< number of communication steps between two rows
  bool step = false;  ///< true: a column contains the length of the step that ends at the row's time
};

/// Frames that are written as picture files. A frame consists of 8-bit grey pixels in an OSMP binary.
struct PictureDescription {
  VariableName frame;            ///< name of the OSMP binary, without `.base.lo`
  VariableName id;               ///< name of an Integer that changes with every new frame
  std::int32_t width = 0;        ///< width of the frame in pixels
  std::int64_t interval_ns = 0;  ///< minimum time between two pictures; 0: every frame is written
  std::string place;
};

/// A curve in a panel of the run's page. The kind of the panel determines whether it is drawn as a line, a band or a
/// lane.
struct CurveDescription {
  VariableName variable;
  bool rate = false;  ///< true: the page shows the mean rate of change between rows, such as the power for an energy
  std::string label;  ///< label of the curve; empty: the name of the variable
  std::string place;
};

enum class PanelKind {
  lines,  ///< curves in common axes
  stack,  ///< stacked areas, which show parts of a whole
  lanes,  ///< one lane for each curve; shows states, and shares of the time as shades
};

struct PanelDescription {
  std::string title;
  PanelKind kind = PanelKind::lines;
  std::vector<CurveDescription> curves;
};

/// The contents of the page of a run. They do not affect computed or recorded values.
struct ViewDescription {
  /// Name of a String that is read once, at t = 0, and contains a scene in the format of docs/seeing.md.
  std::optional<VariableName> scene;
  std::string scene_place;
  std::vector<PanelDescription> panels;
  std::vector<std::string> marks;  ///< instances whose messages are marked on the timeline
};

/// A power bond: two connections that transfer power between two instances. The power is the product of their values,
/// such as force and velocity.
struct BondDescription {
  std::string name;
  VariableName effort;  ///< the input that receives the effort
  VariableName flow;    ///< the input that receives the flow; it belongs to the instance that provides the effort
  double limit = 0.01;  ///< maximum energy that the coupling may create or lose, relative to the exchanged energy
  std::string place;
};

/// Selects the quantities in the coupling report, and the limits above which it warns.
struct CouplingDescription {
  std::optional<double> input_limit;  ///< maximum root mean square deviation of an input, relative to the input's range
  std::vector<BondDescription> bonds;
};

/// Selects the log categories of an instance whose ordinary messages are shown; "*" selects all.
struct LogDescription {
  std::string instance;
  std::vector<std::string> categories;
};

/// The log categories that are shown for an instance without a setting in the config.
inline constexpr std::string_view kDefaultLogCategories[] = {"console", "events", "faults", "observe"};

/// A special value of SystemDescription::threads: as many threads as the machine can run at the same time.
inline constexpr unsigned kAutomaticThreads = 0;

/// Finds instances by name. The first search builds an index of the names, which must not change afterwards.
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
  std::filesystem::path file;  ///< path of the config, FMU or SSP
  std::string name;            ///< name of the file without extension
  std::string source;          ///< content of the file, for the hash of the inputs
  ExactTime step;              ///< communication step
  std::int64_t start_time_ns = 0;
  std::int64_t stop_time_ns = 0;  ///< internal time of a communication point, see TimeGrid
  bool single_fmu = false;  ///< true if this describes a single FMU, whose variables can be named without an instance
  std::vector<InstanceDescription> instances;
  std::vector<ConnectionDescription> connections;
  AlgorithmDescription algorithm;
  std::optional<StepControlDescription> step_control;  ///< nullopt: every communication step has the length `step`
  SolverDescription solver;  ///< applies to continuous systems that have no solver settings of their own
  std::vector<ConditionDescription> stop_when;  ///< the run ends as soon as one of them is true
  std::vector<OutcomeDescription> outcomes;     ///< the first one that applies is the outcome
  std::vector<InputsDescription> inputs;        ///< files that are the sources of unconnected inputs
  std::vector<OverrideDescription> scenario;    ///< overrides of the same variable are applied in this order
  std::vector<SummaryEntry> summary;
  RecordDescription record;
  std::vector<PictureDescription> pictures;
  ViewDescription view;
  std::optional<CouplingDescription> coupling;  ///< nullopt: no coupling report is written
  std::vector<LogDescription> log;
  bool draws_calibration = false;  ///< true if the config has "uncertainty": "calibration"
  unsigned threads = 1;  ///< maximum number of threads that step slaves; used only if stepping in parallel is faster
  std::vector<std::string> notices;                            ///< notices of the reader that the user should see
  std::shared_ptr<const modeldesc::TemporaryFolder> unpacked;  ///< the folder that contains the FMUs of an SSP

  InstanceIndex index;

  TimeGrid grid() const { return {start_time_ns, step}; }
  /// Returns the duration of `count` steps.
  ExactTime length_of(std::int64_t count) const;
  /// Returns the step of an instance as a time.
  ExactTime step_of(const InstanceDescription& instance) const;
  /// Returns the index of an instance in `instances`. Searches by name must not be called by two threads at the same
  /// time.
  std::optional<std::size_t> index_of(std::string_view instance_name) const;
  const InstanceDescription* find_instance(std::string_view instance_name) const;
  std::vector<std::string> instance_names() const;
  /// Splits "instance.variable" according to the names of the instances. Returns nullopt if no instance matches. In the
  /// system of a single FMU, a text that matches no instance is the name of a variable of that FMU.
  std::optional<VariableName> split(std::string_view text) const;
};

/// Splits "instance.variable". If no instance matches, splits the text at its first dot. Throws InputError if one part
/// is missing.
VariableName parse_variable(const SystemDescription& system, std::string_view text, const std::string& place);

/// A setting for which the instance was found.
struct LocatedSetting {
  InstanceDescription* instance = nullptr;
  Assignment assignment;
};

/// Finds the instance to which a setting applies. Throws InputError with similar names if the system has no such
/// instance.
LocatedSetting locate(SystemDescription& system, const Setting& setting);

/// Returns the reason why a run cannot end at this time. Returns nullopt if it can. The duration of a run must be a
/// multiple of the steps of all instances.
std::optional<std::string> stop_time_problem(const SystemDescription& system, std::int64_t stop_time_ns);

/// Sets the time at which the run ends, as `--stop-time` does. Throws InputError if stop_time_problem() returns a
/// reason.
void set_stop_time(SystemDescription& system, std::int64_t stop_time_ns, const std::string& place);

}  // namespace mebots::master
