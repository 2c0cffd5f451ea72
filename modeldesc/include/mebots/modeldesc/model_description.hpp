// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi2/variable_kinds.hpp"
#include "mebots/modeldesc/units.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

/// What a modelDescription.xml of FMI 2.0 says, as plain data: ours and foreign ones alike.
namespace mebots::modeldesc {

using fmi2::Causality;
using fmi2::Initial;
using fmi2::to_string;
using fmi2::Type;
using fmi2::Variability;

/// A start value; Integer and Enumeration both hold std::int32_t. Empty when none is given.
using Value = std::variant<std::monostate, double, std::int32_t, bool, std::string>;

struct EnumerationItem {
  std::string name;
  std::int32_t value = 0;
  std::string text;
  bool operator==(const EnumerationItem&) const = default;
};

/// A <SimpleType>.
struct TypeDefinition {
  std::string name;
  std::string text;
  Type type = Type::real;
  std::string quantity;
  std::string unit;
  std::string display_unit;
  std::optional<double> min;
  std::optional<double> max;
  std::optional<double> nominal;
  std::vector<EnumerationItem> items;  // of an enumeration
  bool operator==(const TypeDefinition&) const = default;
};

/// Marks an Integer variable as one third of an OSMP binary variable (a pointer's halves and a size).
struct OsmpPart {
  std::string name;  // of the whole, `camera.frame`
  std::string role;  // `base.lo`, `base.hi` or `size`
  std::string mime_type;
  bool operator==(const OsmpPart&) const = default;
};

/// A <ScalarVariable>. Unit, quantity, min, max and nominal of its declared type are already filled in
/// where the variable itself has none, and so are FMI's defaults for causality, variability and initial.
struct Variable {
  std::string name;
  std::uint32_t value_reference = 0;
  Type type = Type::real;
  Causality causality = Causality::local;
  Variability variability = Variability::continuous;
  std::optional<Initial> initial;  // none for inputs and the independent variable
  Value start;
  std::string declared_type;
  std::string quantity;
  std::string unit;  // empty = none
  std::string display_unit;
  std::optional<double> min;
  std::optional<double> max;
  std::optional<double> nominal;
  std::optional<std::size_t> derivative_of;  // index in ModelDescription::variables
  bool relative_quantity = false;
  bool reinit = false;
  bool can_handle_multiple_set_per_time_instant = true;
  std::string text;
  std::optional<OsmpPart> osmp;
  bool operator==(const Variable&) const = default;
};

/// An entry of the model structure. Indices count from 0 in ModelDescription::variables.
struct Unknown {
  std::size_t variable = 0;
  std::optional<std::vector<std::size_t>> dependencies;  // none = may depend on every known
  std::vector<std::string> dependency_kinds;             // empty or one per dependency
  bool operator==(const Unknown&) const = default;
};

/// What <CoSimulation> and <ModelExchange> have in common.
struct Implementation {
  std::string model_identifier;  // name of the shared library without suffix
  bool needs_execution_tool = false;
  bool can_be_instantiated_only_once_per_process = false;
  bool can_not_use_memory_management_functions = false;
  bool can_get_and_set_fmu_state = false;
  bool can_serialize_fmu_state = false;
  bool provides_directional_derivative = false;
  std::vector<std::string> source_files;
  bool operator==(const Implementation&) const = default;
};

/// The <CoSimulation> element: present when the FMU can be stepped.
struct CoSimulation : Implementation {
  bool can_handle_variable_communication_step_size = false;
  bool can_interpolate_inputs = false;
  std::uint32_t max_output_derivative_order = 0;
  bool can_run_asynchronuously = false;
  bool operator==(const CoSimulation&) const = default;
};

/// The <ModelExchange> element: present when the FMU gives derivatives for a solver outside.
struct ModelExchange : Implementation {
  bool completed_integrator_step_not_needed = false;
  bool operator==(const ModelExchange&) const = default;
};

struct DefaultExperiment {
  std::optional<double> start_time_s;
  std::optional<double> stop_time_s;
  std::optional<double> tolerance;
  std::optional<double> step_size_s;
  bool operator==(const DefaultExperiment&) const = default;

  /// The tolerance if an FMU can be given it: a finite number above 0.
  std::optional<double> usable_tolerance() const;
};

struct LogCategory {
  std::string name;
  std::string text;
  bool operator==(const LogCategory&) const = default;
};

/// The positions of a list's elements, sorted by their names, so that looking one up takes logarithmic time. Four bytes
/// per element.
class NameIndex {
 public:
  /// Indexes elements with a member `name`. Of equal names the first one is found.
  template <typename T>
  void build(const std::vector<T>& list) {
    positions_.resize(list.size());
    std::iota(positions_.begin(), positions_.end(), std::uint32_t{0});
    std::ranges::stable_sort(positions_, {}, [&](std::uint32_t i) { return std::string_view(list[i].name); });
  }
  /// The element of `list` that has this name, or null. If the list has another size than the indexed one, searches it
  /// from the front.
  template <typename T>
  const T* find(const std::vector<T>& list, std::string_view name) const {
    if (positions_.size() != list.size()) {
      const auto found = std::ranges::find(list, name, &T::name);
      return found == list.end() ? nullptr : &*found;
    }
    const auto name_of = [&](std::uint32_t i) { return std::string_view(list[i].name); };
    const auto found = std::ranges::lower_bound(positions_, name, {}, name_of);
    return found == positions_.end() || name_of(*found) != name ? nullptr : &list[*found];
  }
  /// Two descriptions are equal if their lists are.
  bool operator==(const NameIndex& /*other*/) const { return true; }

 private:
  std::vector<std::uint32_t> positions_;
};

struct ModelDescription {
  std::string fmi_version;  // "2.0"
  std::string model_name;
  std::string guid;
  std::string text;
  std::string author;
  std::string version;
  std::string copyright;
  std::string license;
  std::string generation_tool;
  std::string generation_date_and_time;
  bool structured_names = false;  // variableNamingConvention
  std::uint32_t number_of_event_indicators = 0;
  std::optional<ModelExchange> model_exchange;
  std::optional<CoSimulation> co_simulation;
  std::vector<Unit> units;
  std::vector<TypeDefinition> types;
  std::vector<LogCategory> log_categories;
  DefaultExperiment default_experiment;
  std::vector<Variable> variables;  // in the order of the file
  std::vector<Unknown> outputs;
  std::vector<Unknown> derivatives;
  std::vector<Unknown> initial_unknowns;
  std::vector<std::string> structure_faults;  // of ModelStructure: what is wrong and where; these parts are left out
  bool operator==(const ModelDescription&) const = default;

  /// Indexes variables, units and types by name. Readers of descriptions call it last. Lists that change afterwards
  /// must keep names and order, or be indexed again.
  void index_names();
  /// Returns the variable of this name, or null. Takes logarithmic time after index_names(), else linear time.
  const Variable* find(std::string_view name) const { return variable_index.find(variables, name); }
  /// Returns the unit definition of this name, or null.
  const Unit* unit(std::string_view name) const { return unit_index.find(units, name); }
  /// Returns the type definition of this name, or null.
  const TypeDefinition* type_definition(std::string_view name) const { return type_index.find(types, name); }

  NameIndex variable_index;
  NameIndex unit_index;
  NameIndex type_index;
};

}  // namespace mebots::modeldesc
