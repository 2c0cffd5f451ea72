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

/// Describes a system before its FMUs are opened. The description does not depend on the file format.
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

/// Returns the text of a value for messages. Strings are in quotes.
std::string written_text(const WrittenValue& written);

/// A start value of a variable. Error messages contain `place`, its location in the file.
struct Assignment {
  std::string variable;
  WrittenValue value;
  std::string place;
};

enum class ProcessKind {
  shared,     ///< runs the instance in the process of the master
  own,        ///< runs the instance in a separate process
  sandboxed,  ///< runs the instance in a separate process with access to few files (docs/master/isolation.md)
};

struct SandboxDescription {
  std::vector<std::string> reads;     ///< absolute paths that the FMU may read in addition to the default
  std::vector<std::string> may_lack;  ///< names of sandbox mechanisms that may be unavailable on this machine
};

/// Selects the process of an instance and its limits. An instance that exceeds a limit counts as failed.
struct IsolationDescription {
  std::optional<ProcessKind> process;         ///< nullopt if the user selects none
  std::optional<double> deadline_s;           ///< maximum wall time of each call to the FMU
  std::optional<std::uint64_t> memory_bytes;  ///< maximum memory of the instance's separate process
  bool continue_without = false;              ///< true: the run continues if the instance fails
  SandboxDescription sandbox;

  static constexpr std::uint64_t kDefaultMemoryBytes = std::uint64_t{1024} << 20;
  static constexpr std::uint64_t kNoMemoryLimit = 0;

  /// True if the instance runs in a separate process. If `process` is absent, a deadline or a memory limit requires
  /// one.
  bool alone() const {
    return process ? *process != ProcessKind::shared : deadline_s.has_value() || memory_bytes.has_value();
  }
  bool sandboxed() const { return process == ProcessKind::sandboxed; }
};

struct InstanceDescription {
  std::string name;
  std::string fmu;                 ///< name or path in the config
  std::filesystem::path fmu_path;  ///< absolute path
  std::vector<Assignment> parameters;
  std::int64_t steps = 1;           ///< step of the instance as a multiple of the system's step
  bool divide_discarded = false;    ///< true: divides a step that the FMU discards into parts; false: ends the run
  bool pass_stop_time = false;      ///< true: passes the stop time of the run to fmi2SetupExperiment
  bool pass_tolerance = true;       ///< true: passes the tolerance, if there is one, to fmi2SetupExperiment
  std::optional<double> tolerance;  ///< nullopt: the FMU's default applies
  IsolationDescription isolation;
  std::optional<FmuKind> kind;              ///< nullopt: co-simulation if the FMU offers it
  std::optional<SolverDescription> solver;  ///< nullopt: the solver settings of the whole system apply
  std::string place;
};

/// An entry of a connection's map. If the output has the value `from`, the input receives the value `to`.
struct MappedValue {
  std::string from;
  WrittenValue to;
  std::string place;
};

/// A connection. The input is factor * x + offset. x is the value of the output, converted to the unit of the input.
struct ConnectionDescription {
  VariableName from;
  VariableName to;
  std::string place;
  double factor = 1;
  double offset = 0;
  bool convert_units = true;  ///< false: x is the value of the output in its own unit
  bool narrow = false;        ///< true: permits an input type that cannot represent all values of the output type
  bool sum = false;           ///< true: the input is the sum of all its connections
  /// For Integers, enumerations and Booleans. Values without an entry are not changed.
  std::vector<MappedValue> map;
};

/// Selects the co-simulation algorithm of a run.
struct AlgorithmDescription {
  std::string type = "jacobi";     ///< name from kAlgorithms
  std::vector<std::string> order;  ///< all instances in the order of stepping; empty if the config gives no order
};

enum class AlgorithmType { jacobi, gauss_seidel };

struct AlgorithmKind {
  AlgorithmType type;
  std::string_view name;
  bool takes_order;  ///< true if the config may contain the order of the instances
};

inline constexpr AlgorithmKind kAlgorithms[] = {
    {.type = AlgorithmType::jacobi, .name = "jacobi", .takes_order = false},
    {.type = AlgorithmType::gauss_seidel, .name = "gauss-seidel", .takes_order = true},
};

/// Finds an algorithm by its name. Throws InputError with similar names if there is no such algorithm. Throws
/// InputError if the description contains an order and the algorithm does not use one. The error messages contain no
/// place in the file.
const AlgorithmKind& find_algorithm(const AlgorithmDescription& description);

enum class Comparison { equals, above, below };

enum class Quantifier {
  none,   ///< compares one variable with a value
  all,    ///< true if all members are true
  any,    ///< true if at least one member is true
  count,  ///< compares the number of true members with a value
};

/// Compares `variable` with `value`, or applies the quantifier to `members`.
struct ConditionDescription {
  VariableName variable;
  Quantifier quantifier = Quantifier::none;
  std::vector<ConditionDescription> members;  ///< conditions to which the quantifier applies
  Comparison comparison = Comparison::equals;
  WrittenValue value;
  std::int64_t for_ns = 0;  ///< duration for which the condition must be true without interruption
  bool ever = false;        ///< true: the condition stays true after it was true at one communication point
  std::string place;
};

/// An outcome of a run. It applies if all conditions are true at the end of the run.
struct OutcomeDescription {
  std::string outcome;
  std::vector<ConditionDescription> when;
};

enum class OverrideAction { set, offset, scale, freeze, noise, ramp, signal };

struct SignalFileDescription {
  std::filesystem::path path;  ///< absolute path
  std::string name;            ///< path as written by the user
  std::string time;            ///< title of the time column; empty: the column `time` or `t`
  /// True: a time before the first row is an error. False: the first values apply before the first row.
  bool covers_start = false;
  bool covers_end = false;  ///< true: a time after the last row is an error
  std::string place;
};

struct SignalColumn {
  std::string column;
  VariableName variable;
  std::string unit;  ///< unit of the column if its title contains none
  std::string place;
};

/// A file with the values of unconnected inputs.
struct InputsDescription {
  SignalFileDescription file;
  std::optional<std::vector<SignalColumn>> to;  ///< nullopt: each column has the name of its input
};

/// An entry of a scenario, which changes a variable during a time or when a condition is true.
struct OverrideDescription {
  std::string text;  ///< description of the entry for users
  VariableName variable;
  OverrideAction action = OverrideAction::set;
  WrittenValue value;  ///< for `set`
  /// Offset for `offset`, factor for `scale`, standard deviation for `noise`, or final value for `ramp`.
  double number = 0;
  std::string unit;                           ///< unit of the value or of the column; empty if the user wrote none
  std::optional<SignalFileDescription> file;  ///< for `signal`
  std::string column;                         ///< for `signal`
  std::uint64_t seed = 0;                     ///< for `noise`
  std::int64_t over_ns = 0;                   ///< for `ramp`: duration of the change to the final value
  std::int64_t from_ns = 0;  ///< start of the override; with `when`, the time from which the condition is evaluated
  std::optional<std::int64_t> until_ns;  ///< end of the override (exclusive)
  /// Condition that starts the override, once.
  std::optional<ConditionDescription> when;
  std::optional<std::int64_t> duration_ns;  ///< duration of the override after its start
  std::string place;
};

/// The final value of one member of a group, such as one of several drones.
struct GroupMember {
  std::string name;
  VariableName variable;
  std::string place;
};

/// A final value in summary.json. `path` contains the nested keys from the outermost to the innermost.
struct SummaryEntry {
  std::vector<std::string> path;
  VariableName variable;
  std::vector<ConditionDescription> when;  ///< the value is left out if one of these conditions is false at the end
  std::string place;
  /// If not empty, the values and statistics of these members are written instead of `variable`.
  std::vector<GroupMember> group = {};
};

/// A pattern of variable names. `*` matches any characters, `?` matches one character.
struct RecordPattern {
  std::string pattern;
  std::string place;
};

struct RecordDescription {
  std::optional<std::vector<RecordPattern>> patterns;  ///< nullopt: records all Real, Integer and Boolean outputs
  std::vector<RecordPattern> exclude;                  ///< matching variables are not recorded
  std::vector<RecordPattern> parameters;               ///< matching variables are recorded once, at t = 0
  bool csv = true;                                     ///< true: writes results.csv
  bool hdf5 = false;                                   ///< true: writes results.h5
  bool texts = false;                                  ///< true: also selects Strings
  bool locals = false;                                 ///< true: also selects local variables
  std::int64_t every_steps = 1;                        ///< number of communication steps between two rows
  bool step = false;  ///< true: adds a column with the length of the step that ends at the time of the row
};

/// Frames of a camera that are written as picture files. A frame is an OSMP binary of 8-bit grey pixels.
struct PictureDescription {
  VariableName frame;            ///< name of the OSMP binary, without `.base.lo`
  VariableName id;               ///< name of an Integer that differs between consecutive frames
  std::int32_t width = 0;        ///< in pixels
  std::int64_t interval_ns = 0;  ///< minimum time between two pictures; 0: writes every frame
  std::string place;
};

struct CurveDescription {
  VariableName variable;
  bool rate = false;  ///< true: shows the mean rate of change between rows, such as the power of an energy
  std::string label;  ///< empty: the name of the variable
  std::string place;
};

enum class PanelKind {
  lines,  ///< curves in common axes
  stack,  ///< stacked areas, which show parts of a whole
  lanes,  ///< one lane for each curve, for states
};

struct PanelDescription {
  std::string title;
  PanelKind kind = PanelKind::lines;
  std::vector<CurveDescription> curves;
};

/// The contents of the HTML page of a run. They do not affect the results.
struct ViewDescription {
  /// A String that contains a scene in the format of docs/seeing.md. It is read once, at t = 0.
  std::optional<VariableName> scene;
  std::string scene_place;
  std::vector<PanelDescription> panels;
  std::vector<std::string> marks;  ///< instances whose messages are marked on the timeline
};

/// A power bond: two connections between two instances. The product of their values, such as force and velocity, is the
/// transferred power.
struct BondDescription {
  std::string name;
  VariableName effort;  ///< the input that receives the effort
  VariableName flow;    ///< the input of the other instance that receives the flow
  double limit = 0.01;  ///< maximum energy that the coupling may create or lose, relative to the transferred energy
  std::string place;
};

/// Selects the contents of the coupling report, and the limits for its warnings.
struct CouplingDescription {
  std::optional<double> input_limit;  ///< maximum root mean square deviation of an input relative to its range
  std::vector<BondDescription> bonds;
};

/// Selects the log categories of an instance whose ordinary messages are shown; "*" selects all.
struct LogDescription {
  std::string instance;
  std::vector<std::string> categories;
};

/// The log categories that are shown if the config selects none.
inline constexpr std::string_view kDefaultLogCategories[] = {"console", "events", "faults", "observe"};

/// Value of SystemDescription::threads that selects the number of hardware threads.
inline constexpr unsigned kAutomaticThreads = 0;

/// Finds instances by name. Names must not change after the first search, which stores them in an index.
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
  ExactTime step;
  std::int64_t start_time_ns = 0;
  std::int64_t stop_time_ns = 0;  ///< must be the time of a communication point, see TimeGrid
  bool single_fmu = false;        ///< true: variables can be named without an instance
  std::vector<InstanceDescription> instances;
  std::vector<ConnectionDescription> connections;
  AlgorithmDescription algorithm;
  std::optional<StepControlDescription> step_control;  ///< nullopt: all communication steps have the length `step`
  SolverDescription solver;                            ///< for continuous systems without their own solver settings
  std::vector<ConditionDescription> stop_when;         ///< the run ends when one of these conditions is true
  std::vector<OutcomeDescription> outcomes;            ///< the first one that applies is the outcome of the run
  std::vector<InputsDescription> inputs;               ///< files with values of unconnected inputs
  std::vector<OverrideDescription> scenario;           ///< overrides of the same variable are applied in this order
  std::vector<SummaryEntry> summary;
  RecordDescription record;
  std::vector<PictureDescription> pictures;
  ViewDescription view;
  std::optional<CouplingDescription> coupling;  ///< nullopt: writes no coupling report
  std::vector<LogDescription> log;
  bool draws_calibration = false;  ///< true: the config contains "uncertainty": "calibration"
  unsigned threads = 1;            ///< maximum number of threads for stepping instances
  std::vector<std::string> notices;
  std::shared_ptr<const modeldesc::TemporaryFolder> unpacked;  ///< folder with the FMUs of an SSP

  InstanceIndex index;

  TimeGrid grid() const { return {start_time_ns, step}; }
  /// Returns the duration of `count` communication steps.
  ExactTime length_of(std::int64_t count) const;
  ExactTime step_of(const InstanceDescription& instance) const;
  /// Returns the index of an instance in `instances`. Two threads must not search by name at the same time.
  std::optional<std::size_t> index_of(std::string_view instance_name) const;
  const InstanceDescription* find_instance(std::string_view instance_name) const;
  std::vector<std::string> instance_names() const;
  /// Splits "instance.variable" after the name of an instance. Returns nullopt if the text does not start with the name
  /// of an instance. If the system is a single FMU, a text without an instance is the name of one of its variables.
  std::optional<VariableName> split(std::string_view text) const;
};

/// Splits "instance.variable" like split(). If no instance matches, splits the text at its first dot. Throws InputError
/// if a part is empty.
VariableName parse_variable(const SystemDescription& system, std::string_view text, const std::string& place);

struct LocatedSetting {
  InstanceDescription* instance = nullptr;
  Assignment assignment;
};

/// Finds the instance to which a setting applies. Throws InputError with similar names if there is no such instance.
LocatedSetting locate(SystemDescription& system, const Setting& setting);

/// Returns the reason why a run cannot end at this time; nullopt if it can. The duration of a run must be a multiple of
/// the steps of all instances.
std::optional<std::string> stop_time_problem(const SystemDescription& system, std::int64_t stop_time_ns);

/// Sets the time at which the run ends. Throws InputError if stop_time_problem() returns a reason.
void set_stop_time(SystemDescription& system, std::int64_t stop_time_ns, const std::string& place);

}  // namespace mebots::master
