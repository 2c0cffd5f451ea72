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

/// Declares the system after all names were resolved and checked.
namespace mebots::master {

class Fmu;

/// A variable of an instance. Points into the description of the instance's FMU, which exists as long as the system.
struct ResolvedVariable {
  std::size_t instance = 0;
  const modeldesc::Variable* variable = nullptr;

  bool operator==(const ResolvedVariable&) const = default;
  auto operator<=>(const ResolvedVariable&) const = default;
};

/// The start value of a scalar, which is set before initialisation.
struct StartValue {
  const modeldesc::Variable* variable = nullptr;
  modeldesc::Value value;
};

/// An entry of a connection's map. If the output has the value `from`, the input receives the value `to`. Enumerations
/// are represented by the numbers of their items, Booleans by 0 and 1.
struct ValuePair {
  std::int64_t from = 0;
  std::int64_t to = 0;

  bool operator==(const ValuePair&) const = default;
};

/// A connection of two scalars. The input is factor * output + offset. Factor and offset include the conversion of
/// units. If the input is not a Real, the factor is 1 and the offset is 0.
struct ResolvedConnection {
  ResolvedVariable from;
  ResolvedVariable to;
  /// True if the connection transfers one of the three Integers of an OSMP binary. The pointer in them is valid only in
  /// this process and for a limited time.
  bool pointer = false;
  double factor = 1;
  double offset = 0;
  /// True if the solver of a continuous system evaluates the connection. It is then not evaluated at communication
  /// points.
  bool inner = false;
  /// True between a Binary and an OSMP binary. The variable of the OSMP binary is then its `base.lo`.
  bool converts = false;
  bool narrows = false;             ///< true if values outside of the range of the input's type are an error
  bool sum = false;                 ///< true if the input is the sum of all connections that end at it
  std::vector<ValuePair> map = {};  ///< sorted by `from`; values without an entry are not changed

  bool changes_value() const { return factor != 1 || offset != 0; }
  /// True for a connection of Reals that is evaluated at communication points and is the only source of its input.
  bool moves_real() const;
  /// True if moves_real() is true and both variables are continuous.
  bool is_continuous() const;
};

/// Settings for an FMU that contains an interpreter, such as Python.
struct Interpreter {
  bool embedded = false;  ///< true: the FMU's library is not unloaded, because interpreters cannot be unloaded safely
  /// Path of Python's library if the FMU uses its symbols but does not declare the dependency; otherwise empty.
  std::string library;
  std::string python_path;  ///< folder with the packages of the virtual environment, for PYTHONPATH
};

struct ResolvedInstance {
  const InstanceDescription* description = nullptr;
  std::shared_ptr<Fmu> fmu;                ///< must not be used by model/, which is below the layer of Fmu
  modeldesc::StructuralValues structural;  ///< values of structural parameters (FMI 3.0) that the system sets
  /// Description of the FMU. Each array is replaced by its elements.
  std::shared_ptr<const modeldesc::ModelDescription> model;
  FmuKind kind = FmuKind::co_simulation;
  bool clocks_tick = false;        ///< true if the master handles the clocks of the instance
  IsolationDescription isolation;  ///< isolation of the config; a separate process if the FMU cannot share one
  Interpreter interpreter;         ///< used only if the FMU runs in a separate process
  std::vector<StartValue> starts;
  std::vector<std::string> log_categories;
  /// The tolerance of the config or, if absent, the default of the FMU.
  std::optional<double> tolerance;

  /// Returns the element <CoSimulation> or <ModelExchange> of the FMU.
  const modeldesc::Implementation& implementation() const { return *implementation_of(*model, kind); }
  Experiment experiment(std::int64_t start_ns, std::int64_t stop_ns) const;
};

/// Model exchange instances that are integrated together by one solver.
struct ResolvedContinuousSystem {
  std::vector<std::size_t> members;  ///< in the order of the config
  const SolverDescription* solver = nullptr;
  std::vector<ResolvedConnection> clock_connections = {};
};

/// Co-simulation instances whose clocks are connected, or a single instance with clocks. The members step together to
/// the next tick.
struct ResolvedClockGroup {
  std::vector<std::size_t> members;             ///< in the order of the config
  std::vector<ResolvedConnection> connections;  ///< connections between clocks, and between clocked variables
};

/// An input or a power bond whose coupling error is measured by step control.
struct MeasuredCoupling {
  std::string name;
  CouplingTolerance tolerance = {};
  const BondDescription* bond = nullptr;  ///< null if an input is measured
  std::size_t connection = 0;             ///< index in ResolvedSystem::connections
};

/// The inputs and bonds that step control measures, and whether it repeats steps whose error is too large.
struct ResolvedStepControl {
  std::vector<MeasuredCoupling> measured;
  bool rolls_back = false;
};

/// An unconnected input and the column of a file that contains its values.
struct InputSignal {
  OverrideDescription description;
  std::shared_ptr<const Signal> signal;
};

struct ResolvedSystem {
  const SystemDescription* description = nullptr;
  std::vector<ResolvedInstance> instances;       ///< in the order of the config
  std::vector<ResolvedConnection> connections;   ///< sorted by target, so that their order in the config has no effect
  std::vector<ResolvedClockGroup> clock_groups;  ///< `connections` does not contain the connections inside these groups
  /// The systems of model exchange instances. Every such instance is in exactly one of them. Connections between their
  /// clocks are stored in these systems, not in `connections`.
  std::vector<ResolvedContinuousSystem> continuous_systems;
  std::optional<ResolvedStepControl> step_control;  ///< set if the description contains step control
  /// Sorted by target, so that their order in the config has no effect.
  std::map<ResolvedVariable, InputSignal> inputs;
  /// Indexed like the entries of the scenario; null for entries whose action is not `signal`.
  std::vector<std::shared_ptr<const Signal>> scenario_signals;
  std::vector<std::string> notices;  ///< facts that the user should see, such as unconnected inputs

  /// Returns the signal that is the source of an input. Returns null if the input has no signal.
  const InputSignal* input_signal(const ResolvedVariable& input) const;
  /// Finds a variable by its name. Throws InputError with similar names if the variable does not exist. `place` is the
  /// place at which the name was written.
  ResolvedVariable find(const VariableName& name, const std::string& place) const;
  std::string text(const ResolvedVariable& variable) const;
};

/// Resolves and checks a start value. If it is invalid, throws InputError with the place of the assignment and the
/// names of similar variables.
StartValue checked_start(const InstanceDescription& instance, const modeldesc::ModelDescription& description,
                         const Assignment& assignment);

/// Returns the reason why a variable cannot be set before initialisation. Returns an empty text if it can be set.
std::string why_not_settable(const modeldesc::Variable& variable);

/// Converts a value, as written by the user, to the variable's type. A value of an enumeration can be written as the
/// name or number of an item. Throws InputError if the type is wrong, an item is unknown, or the value is outside of
/// the variable's `min` and `max`.
modeldesc::Value typed_value(const modeldesc::ModelDescription& description, const modeldesc::Variable& variable,
                             const WrittenValue& written, const std::string& place);

/// Returns the shortest text that represents the value exactly, such as "1.5e+08", "true" or "lipol_350". The bits of a
/// UInt64 are interpreted as unsigned. A Binary becomes hexadecimal digits, two for each byte.
std::string value_text(modeldesc::Type type, const modeldesc::Value& value);

/// Returns the variables that are recorded in every row, in the order of the instances in the config and of the
/// variables in modelDescription.xml. Throws InputError if a pattern matches no variable.
std::vector<ResolvedVariable> recorded_variables(const ResolvedSystem& system);

/// Returns the variables that are recorded once, at t = 0: parameters of all kinds, and constants. Throws InputError if
/// a pattern matches no parameter.
std::vector<ResolvedVariable> recorded_parameters(const ResolvedSystem& system);

/// True if `text` matches the pattern; `*` matches any number of characters, `?` matches one character.
bool fits(std::string_view text, std::string_view pattern);

}  // namespace mebots::master
