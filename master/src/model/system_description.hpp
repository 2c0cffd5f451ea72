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

/// What a user asks for, before any FMU was opened: instances, connections, and what to do with the
/// results. The config file is one door to it; nothing here depends on the file's format.
namespace mebots::master {

/// A variable of an instance, as "instance.variable" names it. Both may hold dots.
struct VariableName {
  std::string instance;
  std::string variable;

  std::string text() const { return instance + "." + variable; }
  bool operator==(const VariableName&) const = default;
};

/// A value as the user wrote it.
using WrittenValue = Value;

/// Returns the value as a message shows it: texts in quotes.
std::string written_text(const WrittenValue& written);

/// A start value for one variable. `place` says where it was written, for error messages.
struct Assignment {
  std::string variable;
  WrittenValue value;
  std::string place;
};

enum class ProcessKind {
  shared,     ///< the master's
  own,        ///< one of its own, which harms no other
  sandboxed,  ///< one of its own, with access to few files and to nothing else (docs/master/isolation.md)
};

/// A sandbox beyond its defaults.
struct SandboxDescription {
  std::vector<std::string> reads;     ///< absolute paths that the FMU may read, too
  std::vector<std::string> may_lack;  ///< mechanisms without which the FMU runs all the same
};

/// Where an instance runs, and what its failures may cost.
struct IsolationDescription {
  std::optional<ProcessKind> process;         ///< as written
  std::optional<double> deadline_s;           ///< of each call, by the wall clock
  std::optional<std::uint64_t> memory_bytes;  ///< of its own process
  bool go_on_without = false;                 ///< when it fails, the others go on
  SandboxDescription sandbox;

  static constexpr std::uint64_t kDefaultMemoryBytes = std::uint64_t{1024} << 20;
  static constexpr std::uint64_t kNoMemoryLimit = 0;

  /// Whether it runs in a process of its own: where that is asked for, or needed for what is asked for.
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
  std::int64_t steps = 1;           ///< its step, in steps of the system
  bool divide_discarded = false;    ///< repeat a discarded step in parts instead of ending the run
  bool pass_stop_time = false;      ///< fmi2SetupExperiment gets the run's stop time
  bool pass_tolerance = true;       ///< fmi2SetupExperiment gets a tolerance, if there is one
  std::optional<double> tolerance;  ///< if absent, the FMU's default applies
  IsolationDescription isolation;
  std::optional<FmuKind> kind;              ///< as written; if absent, co-simulation if the FMU offers it
  std::optional<SolverDescription> solver;  ///< of its continuous system; if absent, that of the whole system
  std::string place;
};

/// The output's value `from`, as text, becomes `to`.
struct MappedValue {
  std::string from;
  WrittenValue to;
  std::string place;
};

/// The input gets factor * x + offset, with x the output's value in the input's unit.
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

/// Who sees whose outputs within a communication step.
struct AlgorithmDescription {
  std::string type = "jacobi";     ///< the name of one of kAlgorithms
  std::vector<std::string> order;  ///< every instance once; empty = none given
};

enum class AlgorithmType { jacobi, gauss_seidel };

/// An algorithm that a config can name.
struct AlgorithmKind {
  AlgorithmType type;
  std::string_view name;
  bool takes_order;  ///< whether the config may give an order of the instances
};

/// All of them. engine/algorithm/registry.cpp makes each.
inline constexpr AlgorithmKind kAlgorithms[] = {
    {.type = AlgorithmType::jacobi, .name = "jacobi", .takes_order = false},
    {.type = AlgorithmType::gauss_seidel, .name = "gauss-seidel", .takes_order = true},
};

/// Returns the one that the description names. Throws InputError without a place, with the nearest names, if there is
/// none, or if it takes no order and one is given.
const AlgorithmKind& find_algorithm(const AlgorithmDescription& description);

enum class Comparison { equals, above, below };

/// `variable` compared with `value`.
struct ConditionDescription {
  VariableName variable;
  Comparison comparison = Comparison::equals;
  WrittenValue value;
  std::int64_t for_ns = 0;  ///< must have held without a break for so long
  bool ever = false;        ///< counts once it held at any communication point
  std::string place;
};

/// The run's outcome when all of `when` hold at its end. No condition at all always holds.
struct OutcomeDescription {
  std::string outcome;
  std::vector<ConditionDescription> when;
};

enum class OverrideAction { set, offset, scale, freeze, noise, ramp, signal };

/// A CSV file with the courses of variables over time.
struct SignalFileDescription {
  std::filesystem::path path;  ///< absolute
  std::string name;            ///< as written
  std::string time;            ///< the column of times; empty = the one named time or t
  bool covers_start = false;   ///< refused if the run needs times before the first row; else the first values hold
  bool covers_end = false;     ///< the same after the last row
  std::string place;
};

/// A column that becomes an input.
struct SignalColumn {
  std::string column;
  VariableName variable;
  std::string unit;  ///< of the column, if its title has none
  std::string place;
};

/// A file whose columns are the sources of free inputs.
struct InputsDescription {
  SignalFileDescription file;
  std::optional<std::vector<SignalColumn>> to;  ///< nothing = columns are named after their inputs
};

/// One entry of a scenario: what happens to a variable, and when.
struct OverrideDescription {
  std::string text;  ///< for people
  VariableName variable;
  OverrideAction action = OverrideAction::set;
  WrittenValue value;                         ///< `set`
  double number = 0;                          ///< `offset`, `scale`, standard deviation of `noise`, goal of `ramp`
  std::string unit;                           ///< as written, to be checked (`signal`: of the column); may be empty
  std::optional<SignalFileDescription> file;  ///< `signal`
  std::string column;                         ///< `signal`
  std::uint64_t seed = 0;                     ///< `noise`
  std::int64_t over_ns = 0;                   ///< `ramp`: time from the value found to the goal
  std::int64_t from_ns = 0;                   ///< with `when`: the condition counts from then on
  std::optional<std::int64_t> until_ns;       ///< not acting any more at this time
  std::optional<ConditionDescription> when;   ///< begins when this has held for its time, once
  std::optional<std::int64_t> duration_ns;    ///< from its beginning
  std::string place;
};

/// A final value for summary.json, under `path` (labels from outside to inside).
struct SummaryEntry {
  std::vector<std::string> path;
  VariableName variable;
  std::vector<ConditionDescription> when;  ///< all must hold at the end; else the value is left out
  std::string place;
};

/// `*` stands for any characters, `?` for one.
struct RecordPattern {
  std::string pattern;
  std::string place;
};

struct RecordDescription {
  std::optional<std::vector<RecordPattern>> patterns;  ///< nothing = every Real, Integer and Boolean output
  std::vector<RecordPattern> exclude;                  ///< what fits one of these is left out
  std::vector<RecordPattern> parameters;               ///< recorded once, at t = 0
  bool csv = true;                                     ///< into results.csv
  bool hdf5 = false;                                   ///< into results.h5
  bool texts = false;                                  ///< patterns, and the lack of them, choose texts too
  bool locals = false;                                 ///< they choose local variables, too
  std::int64_t every_steps = 1;                        ///< a row at every such communication point
  bool step = false;                                   ///< a column with the length of the step to the row's point
};

/// Frames to keep as picture files: 8-bit grey pixels that an OSMP binary carries.
struct PictureDescription {
  VariableName frame;            ///< name of the binary, without `.base.lo`
  VariableName id;               ///< Integer that changes with every new frame
  std::int32_t width = 0;        ///< pixels per row
  std::int64_t interval_ns = 0;  ///< shortest time from picture to picture; 0 = every frame
  std::string place;
};

/// One line, band or lane of a panel of the run's page.
struct CurveDescription {
  VariableName variable;
  bool rate = false;  ///< shown is its mean rate of change from row to row: power of an energy
  std::string label;  ///< for people; empty = the variable's name
  std::string place;
};

enum class PanelKind {
  lines,  ///< curves over each other
  stack,  ///< one upon the other: parts of a whole
  lanes,  ///< one below the other: states, and shares of the time as shades
};

struct PanelDescription {
  std::string title;
  PanelKind kind = PanelKind::lines;
  std::vector<CurveDescription> curves;
};

/// What the page of a run is to show first. Nothing here changes what is computed or recorded.
struct ViewDescription {
  std::optional<VariableName> scene;  ///< String, read once at t = 0: a scene as docs/seeing.md describes it
  std::string scene_place;
  std::vector<PanelDescription> panels;
  std::vector<std::string> marks;  ///< instances whose messages are marks on the timeline
};

/// Two connections whose product is the power that goes from one instance to another, such as force and velocity.
struct BondDescription {
  std::string name;
  VariableName effort;  ///< the connected input that takes the effort
  VariableName flow;    ///< the connected input that takes the flow, of the instance that gives the effort
  double limit = 0.01;  ///< most energy that the coupling may make or lose, over the energy that passed
  std::string place;
};

/// What to report about the coupling, and when to warn.
struct CouplingDescription {
  std::optional<double> input_limit;  ///< most deviation of an input (root mean square) over its range
  std::vector<BondDescription> bonds;
};

/// Log categories of one instance whose ordinary messages are shown; "*" = all.
struct LogDescription {
  std::string instance;
  std::vector<std::string> categories;
};

/// Categories that are shown when the config says nothing else about an instance.
inline constexpr std::string_view kDefaultLogCategories[] = {"console", "events", "faults", "observe"};

/// SystemDescription::threads: as many as the machine runs at the same time.
inline constexpr unsigned kAutomaticThreads = 0;

/// Finds instances by their names. It learns them when it is first asked: from then on a name does not change.
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
  std::string name;            ///< its file name without extension
  std::string source;          ///< its bytes, for the hash of the inputs
  ExactTime step;              ///< communication step
  std::int64_t start_time_ns = 0;
  std::int64_t stop_time_ns = 0;  ///< internal time of a communication point, see TimeGrid
  bool single_fmu = false;        ///< made from an FMU alone: names of variables need no instance in front
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
  std::optional<CouplingDescription> coupling;  ///< nothing = no report
  std::vector<LogDescription> log;
  bool draws_calibration = false;    ///< "uncertainty": "calibration"
  unsigned threads = 1;              ///< the most that step slaves at the same time, where that is faster
  std::vector<std::string> notices;  ///< of the reader, for the user
  std::shared_ptr<const modeldesc::TemporaryFolder> unpacked;  ///< where an SSP's FMUs lie

  InstanceIndex index;

  TimeGrid grid() const { return {start_time_ns, step}; }
  /// The length of `count` steps.
  ExactTime length_of(std::int64_t count) const;
  /// The step of an instance.
  ExactTime step_of(const InstanceDescription& instance) const;
  /// Place among `instances`. Like all that looks for names, for one thread at a time.
  std::optional<std::size_t> index_of(std::string_view instance_name) const;
  const InstanceDescription* find_instance(std::string_view instance_name) const;
  std::vector<std::string> instance_names() const;
  /// Splits "instance.variable" by the names of the instances; returns nothing if no instance fits. In the system of a
  /// single FMU every other text is a variable of that FMU.
  std::optional<VariableName> split(std::string_view text) const;
};

/// "instance.variable" apart; the instance is the first word when none of this name is there. Throws InputError for a
/// text without both.
VariableName parse_variable(const SystemDescription& system, std::string_view text, const std::string& place);

/// A setting with its instance found.
struct LocatedSetting {
  InstanceDescription* instance = nullptr;
  Assignment assignment;
};

/// Throws InputError, with the nearest names, when the system has no such instance.
LocatedSetting locate(SystemDescription& system, const Setting& setting);

/// Why the run cannot end at this time, if it cannot: all steps must go into the time from the start to it
/// without a rest.
std::optional<std::string> stop_time_problem(const SystemDescription& system, std::int64_t stop_time_ns);

/// Changes the end of the run, as `--stop-time` does. Throws InputError when there is a stop_time_problem().
void set_stop_time(SystemDescription& system, std::int64_t stop_time_ns, const std::string& place);

}  // namespace mebots::master
