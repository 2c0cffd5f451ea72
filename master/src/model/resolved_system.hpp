// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/array_elements.hpp"
#include "mebots/modeldesc/model_description.hpp"
#include "model/run_course.hpp"
#include "model/signal.hpp"
#include "model/system_description.hpp"
#include "model/value_kind.hpp"

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// The system after all names were resolved, and after all checks that are possible before the first step.
namespace mebots::master {

class Fmu;

/// A variable of an instance. Points into the description of the instance's FMU, which exists as long as the system.
struct ResolvedVariable {
  std::size_t instance = 0;
  const modeldesc::Variable* variable = nullptr;

  bool operator==(const ResolvedVariable&) const = default;
  auto operator<=>(const ResolvedVariable&) const = default;
};

/// The start value of a scalar, to be set before initialisation.
struct StartValue {
  const modeldesc::Variable* variable = nullptr;
  modeldesc::Value value;
};

/// An entry of a map: the value `from` of the output becomes the value `to` of the input. The values are Integers,
/// numbers of Enumeration items, or Booleans (0 and 1).
struct ValuePair {
  std::int64_t from = 0;
  std::int64_t to = 0;

  bool operator==(const ValuePair&) const = default;
};

/// A scalar connection. A connection between OSMP binaries, or from a Binary to an OSMP binary, becomes three scalar
/// connections; from an OSMP binary to a Binary, it is one. The input is factor * value + offset. Factor and offset
/// include the conversion of units. Only Reals have factors other than 1 or offsets other than 0.
struct ResolvedConnection {
  ResolvedVariable from;
  ResolvedVariable to;
  bool pointer = false;  ///< part of an OSMP binary: valid only in this process, and temporarily
  double factor = 1;
  double offset = 0;
  bool inner = false;               ///< within a continuous system, which evaluates it; not transferred at
                                    ///< communication points
  bool converts = false;            ///< between a Binary and an OSMP binary, whose `base.lo` stands for all
  bool narrows = false;             ///< each value is checked to be in the range of the input's type
  bool sum = false;                 ///< a term of a sum: the input gets the sum over all connections that end at it
  std::vector<ValuePair> map = {};  ///< ordered by `from`; other values pass as they are

  bool changes_value() const { return factor != 1 || offset != 0; }
  /// True if the connection transfers a Real at communication points, and its input has no other source.
  bool moves_real() const;
  /// True if moves_real() is true and both variables are continuous. Only then can the deviation of the input from its
  /// source be measured.
  bool is_continuous() const;
};

/// Settings of the host process for an FMU that embeds an interpreter.
struct Interpreter {
  bool embedded = false;    ///< keep the FMU's library loaded, because interpreters cannot be unloaded safely
  std::string library;      ///< Python's library, if the FMU uses its symbols but does not name a library for them;
                            ///< else empty
  std::string python_path;  ///< added to PYTHONPATH: the packages of the virtual environment
};

struct ResolvedInstance {
  const InstanceDescription* description = nullptr;
  std::shared_ptr<Fmu> fmu;                                  ///< for use by fmi/ and higher layers; not used by model/
  modeldesc::StructuralValues structural;                    ///< structural parameters (FMI 3.0) that the system sets
  std::shared_ptr<const modeldesc::ModelDescription> model;  ///< the FMU's description, with elements in place of
                                                             ///< arrays
  FmuKind kind = FmuKind::co_simulation;
  bool clocks_tick = false;        ///< the master handles its clocks
  IsolationDescription isolation;  ///< as described, or a separate process if the FMU cannot share one
  Interpreter interpreter;         ///< for an FMU in a separate process
  std::vector<StartValue> starts;
  std::vector<std::string> log_categories;
  std::optional<double> tolerance;  ///< for fmi2SetupExperiment: that of the config, else the FMU's default

  /// Returns the declaration in modelDescription.xml for the kind of this instance.
  const modeldesc::Implementation& implementation() const { return *implementation_of(*model, kind); }
  /// Returns the arguments of fmi2SetupExperiment for a run from `start_ns` to `stop_ns`.
  Experiment experiment(std::int64_t start_ns, std::int64_t stop_ns) const;
};

/// Model exchange instances that one solver integrates.
struct ResolvedContinuousSystem {
  std::vector<std::size_t> members;  ///< in the order of the config
  const SolverDescription* solver = nullptr;
  std::vector<ResolvedConnection> clock_connections = {};  ///< between clocks, and between clocked variables
};

/// Co-simulation instances whose clocks are connected, or one instance with clocks. They step together from tick to
/// tick.
struct ResolvedClockGroup {
  std::vector<std::size_t> members;             ///< in the order of the config
  std::vector<ResolvedConnection> connections;  ///< between clocks, and between clocked variables
};

/// An input or bond whose coupling error determines the length of communication steps.
struct MeasuredCoupling {
  std::string name;
  CouplingTolerance tolerance = {};
  const BondDescription* bond = nullptr;  ///< if null, the input of a connection
  std::size_t connection = 0;             ///< place among ResolvedSystem::connections
};

/// What step control measures, and whether it repeats steps with a large error.
struct ResolvedStepControl {
  std::vector<MeasuredCoupling> measured;
  bool rolls_back = false;
};

/// An unconnected input whose source is a column of a file. The column is stored as an override that is active during
/// the whole run.
struct InputSignal {
  OverrideDescription description;
  std::shared_ptr<const Signal> signal;
};

struct ResolvedSystem {
  const SystemDescription* description = nullptr;
  std::vector<ResolvedInstance> instances;       ///< in the order of the config
  std::vector<ResolvedConnection> connections;   ///< ordered by target, so that their order in the config is nothing
  std::vector<ResolvedClockGroup> clock_groups;  ///< their connections are not among those above
  /// Every model exchange instance is in exactly one of these systems. Connections between their clocks are stored in
  /// the systems, not in `connections`.
  std::vector<ResolvedContinuousSystem> continuous_systems;
  std::optional<ResolvedStepControl> step_control;  ///< if the description has one
  std::map<ResolvedVariable, InputSignal> inputs;   ///< by target, so that their order in the config does not matter
  std::vector<std::shared_ptr<const Signal>> scenario_signals;  ///< one per scenario entry; null for other actions
  std::vector<std::string> notices;                             ///< notices for the user, such as unconnected inputs

  /// Returns the signal that is the source of an input; null if there is none.
  const InputSignal* input_signal(const ResolvedVariable& input) const;
  /// Looks up a variable. If the variable does not exist, throws InputError with the nearest names. `place` is the
  /// place at which the name was written.
  ResolvedVariable find(const VariableName& name, const std::string& place) const;
  std::string text(const ResolvedVariable& variable) const;
};

/// Resolves and checks a start value. Throws InputError with the place of the assignment and the names of similar
/// variables.
StartValue checked_start(const InstanceDescription& instance, const modeldesc::ModelDescription& description,
                         const Assignment& assignment);

/// Returns the reason why a variable cannot be set before initialisation; empty if the variable can be set.
std::string why_not_settable(const modeldesc::Variable& variable);

/// Converts a written value to the variable's type. An enumeration value is written as an item's name or number. Throws
/// InputError if the type is wrong, an item is unknown, or the value is outside of the variable's `min` and `max`.
modeldesc::Value typed_value(const modeldesc::ModelDescription& description, const modeldesc::Variable& variable,
                             const WrittenValue& written, const std::string& place);

/// Returns the shortest text that reads back to the same bits, such as "1.5e+08", "true" or "lipol_350". The bits of a
/// UInt64 are read as unsigned. A Binary becomes hexadecimal digits, two per byte.
std::string value_text(modeldesc::Type type, const modeldesc::Value& value);

/// Returns the variables recorded in every row, in the order of instances and descriptions. Throws InputError if a
/// pattern matches no variable.
std::vector<ResolvedVariable> recorded_variables(const ResolvedSystem& system);

/// Returns the variables recorded once, at t = 0: parameters of all kinds, and constants. Throws InputError if a
/// pattern matches no parameter.
std::vector<ResolvedVariable> recorded_parameters(const ResolvedSystem& system);

/// True if `text` matches the pattern; `*` matches any number of characters, `?` matches one character.
bool fits(std::string_view text, std::string_view pattern);

}  // namespace mebots::master
