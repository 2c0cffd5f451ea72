// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi/variable_kinds.hpp"
#include "mebots/modeldesc/units.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

/// Represents a modelDescription.xml of FMI 1.0, 2.0 or 3.0 as plain data.
namespace mebots::modeldesc {

using fmi::Causality;
using fmi::Initial;
using fmi::to_string;
using fmi::Type;
using fmi::Variability;

/// A start value. Whole numbers and enumerations are std::int64_t; a UInt64 has the same 64 bits. Float32 and Float64
/// are double. A Binary is a std::string of its bytes. If the description has no start value, the value is
/// std::monostate.
using Value = std::variant<std::monostate, double, std::int64_t, bool, std::string>;

struct EnumerationItem {
  std::string name;
  std::int64_t value = 0;
  std::string text;
  bool operator==(const EnumerationItem&) const = default;
};

/// The attributes of a <SimpleType> element.
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
  std::vector<EnumerationItem> items;  // the items of an enumeration type
  bool operator==(const TypeDefinition&) const = default;
};

/// Marks an Integer variable as a part of an OSMP binary variable: the low or high half of the pointer, or the size.
struct OsmpPart {
  std::string name;  // name of the binary variable, such as `camera.frame`
  std::string role;  // `base.lo`, `base.hi` or `size`
  std::string mime_type;
  bool operator==(const OsmpPart&) const = default;
};

/// The size of one dimension of an array: a fixed size, or the value reference of a structural parameter.
struct Dimension {
  std::optional<std::uint64_t> start;
  std::optional<std::uint32_t> value_reference;
  bool operator==(const Dimension&) const = default;
};

/// An element of an array variable of FMI 3.0. Created by with_elements().
struct ArrayElement {
  std::string array;                  ///< name of the array
  std::uint32_t array_reference = 0;  ///< value reference of the array in the FMU
  std::size_t index = 0;              ///< index in the array, in row-major order, from 0
  std::size_t count = 1;              ///< number of elements in the array
  bool operator==(const ArrayElement&) const = default;
};

enum class IntervalVariability : std::uint8_t { constant, fixed, tunable, changing, countdown, triggered };
inline constexpr std::string_view kIntervalVariabilityWords[] = {"constant", "fixed",     "tunable",
                                                                 "changing", "countdown", "triggered"};

/// The declared timing of a variable of type Clock.
struct ClockTiming {
  IntervalVariability interval_variability = IntervalVariability::triggered;
  std::optional<double> interval_s;
  double shift_s = 0;
  std::optional<std::uint64_t> interval_counter;  ///< the exact interval is counter / resolution
  std::optional<std::uint64_t> shift_counter;
  std::optional<std::uint64_t> resolution;
  bool supports_fraction = false;
  bool can_be_deactivated = false;
  std::optional<std::uint32_t> priority;
  bool operator==(const ClockTiming&) const = default;

  /// True for time-based Clocks. For such an input, the importer must schedule the ticks.
  bool is_time_based() const { return interval_variability != IntervalVariability::triggered; }
};

/// The attributes that only variables of FMI 3.0 have.
struct Fmi3Part {
  std::vector<Dimension> dimensions;  ///< empty for a scalar
  std::vector<Value> starts;          ///< start values of an array in row-major order; a single value applies to all
                                      ///< elements
  std::vector<std::uint32_t>
      clocks;  ///< value references: the variable may be read and set only at ticks of these Clocks
  std::optional<ClockTiming> timing;      ///< exists only for a Clock
  std::string mime_type;                  ///< used only for a Binary
  std::optional<std::uint64_t> max_size;  ///< used only for a Binary, in bytes
  std::optional<std::uint32_t> previous;
  bool intermediate_update = false;
  std::optional<std::string> alias_of;  ///< name of the variable of which this is an alias
  std::optional<ArrayElement> element;
  bool operator==(const Fmi3Part&) const = default;
};

/// Holds a variable's Fmi3Part. For variables of FMI 2.0, the holder is empty and uses no memory on the heap.
class Fmi3Holder {
 public:
  Fmi3Holder() = default;
  Fmi3Holder(Fmi3Part part) : part_(std::make_shared<const Fmi3Part>(std::move(part))) {}  // NOLINT: a value

  const Fmi3Part& operator*() const {
    static const Fmi3Part kEmpty;
    return part_ == nullptr ? kEmpty : *part_;
  }
  const Fmi3Part* operator->() const { return &**this; }
  bool operator==(const Fmi3Holder& other) const { return **this == *other; }

 private:
  std::shared_ptr<const Fmi3Part> part_;
};

/// A <ScalarVariable> of FMI 1.0 or 2.0, or a variable of FMI 3.0. If the file omits `unit`, `quantity`, `min`, `max`
/// or `nominal`, it has the value of the declared type. If the file omits `causality`, `variability` or `initial`, it
/// has FMI's default.
struct Variable {
  std::string name;
  std::uint32_t value_reference = 0;
  Type type = Type::real;
  Causality causality = Causality::local;
  Variability variability = Variability::continuous;
  std::optional<Initial> initial;  // empty for inputs and the independent variable
  Value start;
  std::string declared_type;
  std::string quantity;
  std::string unit;  // empty: no unit
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
  /// The FMU's value reference of the variable that a negated alias (FMI 1.0) negates. The alias itself has a unique
  /// value reference.
  std::optional<std::uint32_t> negated_reference;
  Fmi3Holder fmi3;
  bool operator==(const Variable&) const = default;
};

/// An entry of the model structure: a variable and the variables on which it depends. Both are indices in
/// ModelDescription::variables.
struct Unknown {
  std::size_t variable = 0;
  std::optional<std::vector<std::size_t>> dependencies;  // empty: the variable may depend on every known
  std::vector<std::string> dependency_kinds;             // empty or one per dependency
  bool operator==(const Unknown&) const = default;
};

/// The attributes that <CoSimulation> and <ModelExchange> share.
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

/// The attributes of the <CoSimulation> element.
struct CoSimulation : Implementation {
  bool can_handle_variable_communication_step_size = false;
  bool can_interpolate_inputs = false;
  std::uint32_t max_output_derivative_order = 0;
  bool can_run_asynchronuously = false;
  // The following attributes exist only in FMI 3.0.
  bool has_event_mode = false;
  bool might_return_early = false;
  bool can_return_early_after_intermediate_update = false;
  bool provides_intermediate_update = false;
  bool provides_evaluate_discrete_states = false;
  std::optional<double> fixed_internal_step_size_s;
  bool operator==(const CoSimulation&) const = default;
};

/// The attributes of the <ModelExchange> element.
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

  /// Returns the tolerance if it can be passed to an FMU: if it is finite and above 0.
  std::optional<double> usable_tolerance() const;
};

struct LogCategory {
  std::string name;
  std::string text;
  bool operator==(const LogCategory&) const = default;
};

/// Indexes a list by name, so that lookups take logarithmic time.
class NameIndex {
 public:
  /// Indexes elements that have a member `name`. If several elements share a name, find() returns the first of them.
  template <typename T>
  void build(const std::vector<T>& list) {
    positions_.resize(list.size());
    std::iota(positions_.begin(), positions_.end(), std::uint32_t{0});
    std::ranges::stable_sort(positions_, {}, [&](std::uint32_t i) { return std::string_view(list[i].name); });
  }
  /// Returns the element of `list` with this name, or null. If the list has changed its size since build(), searches
  /// linearly.
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
  /// Always true, so that the index does not affect the comparison of descriptions.
  bool operator==(const NameIndex& /*other*/) const { return true; }

 private:
  std::vector<std::uint32_t> positions_;
};

struct ModelDescription {
  std::string fmi_version;  // "1.0", "2.0" or "3.0", without the third part that FMI 3.0 permits
  std::string model_name;
  std::string guid;  // instantiationToken in FMI 3.0
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
  bool has_scheduled_execution = false;
  std::optional<CoSimulation> co_simulation;
  std::vector<Unit> units;
  std::vector<TypeDefinition> types;
  std::vector<LogCategory> log_categories;
  DefaultExperiment default_experiment;
  std::vector<Variable> variables;  // in the order of the file
  std::vector<Unknown> outputs;
  std::vector<Unknown> derivatives;
  std::vector<Unknown> initial_unknowns;
  std::vector<Unknown> clocked_states;        // FMI 3.0
  std::vector<Unknown> event_indicators;      // FMI 3.0
  std::vector<std::string> structure_faults;  // errors in ModelStructure with their places; the wrong entries are left
                                              // out
  bool operator==(const ModelDescription&) const = default;

  bool is_fmi1() const { return fmi_version == "1.0"; }
  bool is_fmi3() const { return fmi_version == "3.0"; }

  /// Indexes variables, units and types by name. The functions that read descriptions call it. Call it again after a
  /// change of names or of the order of a list.
  void index_names();
  /// Returns the variable with this name, or null. The search takes logarithmic time after index_names(), and linear
  /// time before.
  const Variable* find(std::string_view name) const { return variable_index.find(variables, name); }
  /// Returns the definition of the unit with this name, or null.
  const Unit* unit(std::string_view name) const { return unit_index.find(units, name); }
  /// Returns the definition of the type with this name, or null.
  const TypeDefinition* type_definition(std::string_view name) const { return type_index.find(types, name); }

  NameIndex variable_index;
  NameIndex unit_index;
  NameIndex type_index;
};

}  // namespace mebots::modeldesc
