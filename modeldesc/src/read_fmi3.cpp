// SPDX-License-Identifier: Apache-2.0
#include "mebots/hexadecimal.hpp"
#include "xml_element.hpp"

#include <cstdint>
#include <limits>
#include <unordered_map>
#include <unordered_set>

namespace mebots::modeldesc {
namespace {

/// Returns the start value of a number or Boolean; empty if the text does not fit the type.
std::optional<Value> parse_value(Type type, std::string_view text) {
  if (fmi::is_float(type)) {
    const auto value = parse_number<double>(text);
    return value ? std::optional<Value>(*value) : std::nullopt;
  }
  if (type == Type::boolean) {
    if (text == "true" || text == "1") return Value(true);
    if (text == "false" || text == "0") return Value(false);
    return std::nullopt;
  }
  if (type == Type::uint64) {
    const auto value = parse_number<std::uint64_t>(text);
    return value ? std::optional<Value>(static_cast<std::int64_t>(*value)) : std::nullopt;
  }
  const auto value = parse_number<std::int64_t>(text);
  const auto limits = type == Type::enumeration ? fmi::limits_of(Type::int64) : fmi::limits_of(type);
  if (!value || *value < limits.low || (*value > 0 && static_cast<std::uint64_t>(*value) > limits.high))
    return std::nullopt;
  return Value(*value);
}

class Fmi3Reader {
 public:
  explicit Fmi3Reader(const Document& document) : root_(document, document.root()) {}

  ModelDescription read() {
    read_root();
    read_kinds();
    read_common(root_, result_);
    root_.child("TypeDefinitions").each_child([&](const Element& e) { read_type(e); });
    read_variables();
    read_structure();
    result_.index_names();
    return std::move(result_);
  }

 private:
  void read_root() {
    result_.fmi_version = "3.0";
    read_head(root_, "instantiationToken", result_);
  }

  static void read_implementation(const Element& element, Implementation& flags) {
    flags.model_identifier = model_identifier(element);
    flags.needs_execution_tool = element.flag("needsExecutionTool", false);
    flags.can_be_instantiated_only_once_per_process = element.flag("canBeInstantiatedOnlyOncePerProcess", false);
    flags.can_get_and_set_fmu_state = element.flag("canGetAndSetFMUState", false);
    flags.can_serialize_fmu_state = element.flag("canSerializeFMUState", false);
    flags.provides_directional_derivative = element.flag("providesDirectionalDerivatives", false);
  }

  void read_kinds() {
    if (const Element element = root_.child("ModelExchange")) {
      ModelExchange& flags = result_.model_exchange.emplace();
      read_implementation(element, flags);
      flags.completed_integrator_step_not_needed = !element.flag("needsCompletedIntegratorStep", false);
    }
    if (const Element element = root_.child("CoSimulation")) {
      CoSimulation& flags = result_.co_simulation.emplace();
      read_implementation(element, flags);
      flags.can_handle_variable_communication_step_size = element.flag("canHandleVariableCommunicationStepSize", false);
      flags.max_output_derivative_order =
          element.number<std::uint32_t>("maxOutputDerivativeOrder", "a count").value_or(0);
      flags.has_event_mode = element.flag("hasEventMode", false);
      flags.might_return_early = element.flag("mightReturnEarlyFromDoStep", false);
      flags.can_return_early_after_intermediate_update = element.flag("canReturnEarlyAfterIntermediateUpdate", false);
      flags.provides_intermediate_update = element.flag("providesIntermediateUpdate", false);
      flags.provides_evaluate_discrete_states = element.flag("providesEvaluateDiscreteStates", false);
      flags.fixed_internal_step_size_s = element.real("fixedInternalStepSize");
    }
    result_.has_scheduled_execution = static_cast<bool>(root_.child("ScheduledExecution"));
    if (!result_.model_exchange && !result_.co_simulation && !result_.has_scheduled_execution)
      root_.fail("there is no <CoSimulation>, <ModelExchange> or <ScheduledExecution>");
  }

  void read_type(const Element& element) {
    std::string_view word = element.name();
    if (!word.ends_with("Type")) element.fail("a type definition is expected, such as <Float64Type>");
    word.remove_suffix(4);
    const auto type = fmi::type_of_word3(word);
    if (!type) element.fail(fmt::format("\"{}\" is not a type of FMI 3.0", word));
    TypeDefinition definition;
    definition.name = element.required_text("name");
    definition.text = element.text("description");
    definition.type = *type;
    read_quantities(element, definition);
    element.each_child("Item", [&](const Element& item) {
      item.required_text("value");
      definition.items.push_back({item.required_text("name"),
                                  *item.number<std::int64_t>("value", "a whole number of 64 bits"),
                                  item.text("description")});
    });
    types_.add(element, std::move(definition), result_.types);
  }

  void read_variables() {
    const Element variables = root_.child("ModelVariables");
    if (!variables) root_.fail("the element <ModelVariables> is missing");
    variables.each_child([&](const Element& element) {
      const auto type = fmi::type_of_word3(element.name());
      if (!type) element.fail(fmt::format("<{}> is not a type of FMI 3.0", element.name()));
      read_variable(element, *type);
    });
    check_references(variables);
  }

  void read_variable(const Element& element, Type type) {
    Variable variable;
    Fmi3Part part;
    variable.name = element.required_text("name");
    variable.type = type;
    element.required_text("valueReference");
    variable.value_reference = *element.number<std::uint32_t>("valueReference", "a whole number of 32 bits");
    variable.text = element.text("description");
    variable.causality = element.word<Causality>("causality", fmi::kCausalityWords3).value_or(Causality::local);
    variable.variability = element.word<Variability>("variability", fmi::kVariabilityWords)
                               .value_or(default_variability(variable.causality, type));
    if (variable.variability == Variability::continuous && !fmi::is_float(type))
      element.fail(fmt::format("\"{}\" is of type {}, so it cannot be continuous", variable.name, element.name()));
    variable.initial = element.word<Initial>("initial", fmi::kInitialWords);
    if (!variable.initial) variable.initial = default_initial(variable.causality, variable.variability);
    variable.can_handle_multiple_set_per_time_instant = element.flag("canHandleMultipleSetPerTimeInstant", true);
    part.intermediate_update = element.flag("intermediateUpdate", false);
    part.previous = element.number<std::uint32_t>("previous", "a value reference");
    for (const auto& word : words_of(element.text("clocks"))) part.clocks.push_back(reference(element, word));
    read_quantity(element, variable);
    read_dimensions(element, part);
    if (type == Type::clock) part.timing = read_timing(element);
    part.mime_type =
        type == Type::binary && !element.has("mimeType") ? "application/octet-stream" : element.text("mimeType");
    part.max_size = element.number<std::uint64_t>("maxSize", "a size");
    read_starts(element, variable, part);
    if (const auto derivative = element.number<std::uint32_t>("derivative", "a value reference"))
      derivatives_.emplace_back(result_.variables.size(), *derivative);
    add(element, variable, part);
    element.each_child("Alias", [&](const Element& alias) {
      Variable other = variable;
      Fmi3Part of_other = part;
      other.name = alias.required_text("name");
      other.text = alias.text("description");
      if (alias.has("displayUnit")) other.display_unit = alias.text("displayUnit");
      of_other.alias_of = variable.name;
      add(alias, std::move(other), std::move(of_other));
    });
  }

  void add(const Element& element, Variable variable, Fmi3Part part) {
    if (!names_.insert(variable.name).second)
      element.fail(fmt::format("two variables have the name \"{}\"", variable.name));
    if (!part.alias_of) {
      const auto [other, is_new] = by_reference_.emplace(variable.value_reference, result_.variables.size());
      if (!is_new)
        element.fail(fmt::format("\"{}\" and \"{}\" have the value reference {}", result_.variables[other->second].name,
                                 variable.name, variable.value_reference));
    }
    variable.fmi3 = std::move(part);
    result_.variables.push_back(std::move(variable));
  }

  static Variability default_variability(Causality causality, Type type) {
    if (causality == Causality::parameter || causality == Causality::calculated_parameter ||
        causality == Causality::structural_parameter)
      return Variability::fixed;
    return fmi::is_float(type) ? Variability::continuous : Variability::discrete;
  }

  void read_quantity(const Element& element, Variable& variable) const {
    variable.declared_type = element.text("declaredType");
    read_quantities(element, variable);
    variable.relative_quantity = element.flag("relativeQuantity", false);
    variable.reinit = element.flag("reinit", false);
    types_.apply(element, result_.types, variable);
  }

  static void read_dimensions(const Element& element, Fmi3Part& part) {
    element.each_child("Dimension", [&](const Element& dimension) {
      Dimension read{dimension.number<std::uint64_t>("start", "a size"),
                     dimension.number<std::uint32_t>("valueReference", "a value reference")};
      if (read.start.has_value() == read.value_reference.has_value())
        dimension.fail("a dimension has either a start or a valueReference");
      part.dimensions.push_back(read);
    });
  }

  static ClockTiming read_timing(const Element& element) {
    ClockTiming timing;
    const auto variability = element.word<IntervalVariability>("intervalVariability", kIntervalVariabilityWords);
    if (!variability) element.fail("the attribute intervalVariability is missing");
    timing.interval_variability = *variability;
    timing.interval_s = element.real("intervalDecimal");
    timing.shift_s = element.real("shiftDecimal").value_or(0);
    timing.interval_counter = element.number<std::uint64_t>("intervalCounter", "a count");
    timing.shift_counter = element.number<std::uint64_t>("shiftCounter", "a count");
    timing.resolution = element.number<std::uint64_t>("resolution", "a count");
    timing.supports_fraction = element.flag("supportsFraction", false);
    timing.can_be_deactivated = element.flag("canBeDeactivated", false);
    timing.priority = element.number<std::uint32_t>("priority", "a count");
    if (timing.resolution == 0) element.fail("resolution is 0, but intervals are divided by it");
    return timing;
  }

  static void read_starts(const Element& element, Variable& variable, Fmi3Part& part) {
    std::vector<Value> values;
    if (variable.type == Type::string || variable.type == Type::binary) {
      element.each_child("Start", [&](const Element& start) {
        const auto text = start.required_text("value");
        if (variable.type == Type::string) return values.push_back(text);
        const auto bytes = bytes_of_hexadecimal(text);
        if (!bytes) start.fail(fmt::format("the start value \"{}\" is not pairs of hexadecimal digits", text));
        values.push_back(*bytes);
      });
    } else if (element.has("start")) {
      for (const auto& word : words_of(element.text("start"))) {
        const auto value = parse_value(variable.type, word);
        if (!value)
          element.fail(fmt::format("the start value \"{}\" of \"{}\" is not a value of type {}", word, variable.name,
                                   element.name()));
        values.push_back(*value);
      }
    }
    if (part.dimensions.empty()) {
      if (values.size() > 1)
        element.fail(fmt::format("\"{}\" has {} start values, but no <Dimension>", variable.name, values.size()));
      if (!values.empty()) variable.start = std::move(values.front());
    } else {
      part.starts = std::move(values);
    }
  }

  static std::uint32_t reference(const Element& element, std::string_view text) {
    const auto value = parse_number<std::uint32_t>(text);
    if (!value) element.fail(fmt::format("\"{}\" is not a value reference", text));
    return *value;
  }

  /// Returns the index of the variable with this value reference. If no variable has it, throws an error that names
  /// `element`.
  std::size_t index(const Element& element, std::uint32_t value_reference, std::string_view what) const {
    const auto found = by_reference_.find(value_reference);
    if (found == by_reference_.end())
      element.fail(fmt::format("{} is the value reference {}, which no variable has", what, value_reference));
    return found->second;
  }

  void check_references(const Element& variables) {
    for (const auto& [variable, reference] : derivatives_) {
      result_.variables[variable].derivative_of =
          index(variables, reference, fmt::format("derivative of \"{}\"", result_.variables[variable].name));
    }
    for (const auto& variable : result_.variables) {
      for (const auto clock : variable.fmi3->clocks) {
        const auto& named = result_.variables[index(variables, clock, fmt::format("a clock of \"{}\"", variable.name))];
        if (named.type != Type::clock)
          variables.fail(fmt::format("\"{}\" names \"{}\" as its clock, which is of type {}", variable.name, named.name,
                                     to_string(named.type)));
      }
      for (const auto& dimension : variable.fmi3->dimensions) {
        if (!dimension.value_reference) continue;
        const auto& named = result_.variables[index(variables, *dimension.value_reference,
                                                    fmt::format("a dimension of \"{}\"", variable.name))];
        if (named.causality != Causality::structural_parameter || named.type != Type::uint64)
          variables.fail(
              fmt::format("a dimension of \"{}\" is \"{}\", which is not a structuralParameter of type UInt64",
                          variable.name, named.name));
      }
    }
  }

  void read_structure() {
    const Element structure = root_.child("ModelStructure");
    if (!structure) root_.fail("the element <ModelStructure> is missing");
    result_.outputs = read_unknowns(structure, "Output");
    result_.derivatives = read_unknowns(structure, "ContinuousStateDerivative");
    result_.initial_unknowns = read_unknowns(structure, "InitialUnknown");
    result_.clocked_states = read_unknowns(structure, "ClockedState");
    result_.event_indicators = read_unknowns(structure, "EventIndicator");
    result_.number_of_event_indicators = static_cast<std::uint32_t>(result_.event_indicators.size());
  }

  std::vector<Unknown> read_unknowns(const Element& structure, const char* name) {
    std::vector<Unknown> unknowns;
    structure.each_child(name, [&](const Element& element) {
      element.required_text("valueReference");
      const auto variable = find(element, *element.number<std::uint32_t>("valueReference", "a value reference"));
      auto unknown =
          read_dependencies(element, [&](std::string_view word) { return find(element, reference(element, word)); });
      if (!variable) return;
      unknown.variable = *variable;
      unknowns.push_back(std::move(unknown));
    });
    return unknowns;
  }

  /// Returns the index of the variable with this value reference in <ModelStructure>. Reports an unknown reference
  /// without an error, because the FMU can run without this entry.
  std::optional<std::size_t> find(const Element& element, std::uint32_t value_reference) {
    const auto found = by_reference_.find(value_reference);
    if (found != by_reference_.end()) return found->second;
    result_.structure_faults.push_back(
        element.located(fmt::format("{} is not the value reference of a variable", value_reference)));
    return std::nullopt;
  }

  Element root_;
  ModelDescription result_;
  std::unordered_set<std::string> names_;  // names of the variables read so far
  std::unordered_map<std::uint32_t, std::size_t> by_reference_;
  DeclaredTypes types_;
  std::vector<std::pair<std::size_t, std::uint32_t>> derivatives_;  // index of the variable, value reference of its
                                                                    // state
};

}  // namespace

ModelDescription read_fmi3(const Document& document) {
  return Fmi3Reader(document).read();
}

}  // namespace mebots::modeldesc
