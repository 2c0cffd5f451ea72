// SPDX-License-Identifier: Apache-2.0
#include "xml_element.hpp"

#include <cstdint>
#include <limits>
#include <unordered_map>
#include <unordered_set>

namespace mebots::modeldesc {
namespace {

// The variabilities of FMI 1.0, in the order of kVariabilityWords1.
enum class Variability1 : std::uint8_t { constant, parameter, discrete, continuous };
enum class Causality1 : std::uint8_t { input, output, internal, none };
enum class Alias : std::uint8_t { none, alias, negated };
constexpr std::string_view kTypeElements[] = {"RealType", "IntegerType", "BooleanType", "StringType",
                                              "EnumerationType"};

class Fmi1Reader {
 public:
  explicit Fmi1Reader(const Document& document) : root_(document, document.root()) {}

  ModelDescription read() {
    result_.fmi_version = "1.0";
    read_head(root_, "guid", result_);
    result_.number_of_event_indicators = root_.number<std::uint32_t>("numberOfEventIndicators", "a count").value_or(0);
    read_implementation();
    read_common(root_, result_);
    root_.child("UnitDefinitions").each_child("BaseUnit", [&](const Element& e) { read_unit(e); });
    root_.child("TypeDefinitions").each_child("Type", [&](const Element& e) { read_type(e); });
    Element variables = root_.child("ModelVariables");
    if (!variables) root_.fail("the element <ModelVariables> is missing");
    variables.each_child("ScalarVariable", [&](const Element& e) {
      if (is_first_of_its_name(e)) read_variable(e);
    });
    give_negated_aliases_their_references();
    result_.index_names();
    for (const auto& [variable, element] : outputs_) read_output(variable, element);
    return std::move(result_);
  }

 private:
  /// Reads <Implementation>. An FMU without this element is for model exchange.
  void read_implementation() {
    const auto identifier = model_identifier(root_);
    const Element implementation = root_.child("Implementation");
    if (!implementation) {
      result_.model_exchange.emplace().model_identifier = identifier;
      return;
    }
    const Element tool = implementation.child("CoSimulation_Tool");
    const Element capabilities = (tool ? tool : implementation.child("CoSimulation_StandAlone")).child("Capabilities");
    CoSimulation& flags = result_.co_simulation.emplace();
    flags.model_identifier = identifier;
    flags.needs_execution_tool = static_cast<bool>(tool);
    flags.can_be_instantiated_only_once_per_process = capabilities.flag("canBeInstantiatedOnlyOncePerProcess", false);
    flags.can_not_use_memory_management_functions = capabilities.flag("canNotUseMemoryManagementFunctions", false);
    flags.can_handle_variable_communication_step_size =
        capabilities.flag("canHandleVariableCommunicationStepSize", false);
    flags.can_interpolate_inputs = capabilities.flag("canInterpolateInputs", false);
    flags.max_output_derivative_order =
        capabilities.number<std::uint32_t>("maxOutputDerivativeOrder", "a count").value_or(0);
    flags.can_run_asynchronuously = capabilities.flag("canRunAsynchronuously", false);
  }

  /// Reads a unit of FMI 1.0, which has a name and no base units.
  void read_unit(const Element& element) {
    Unit unit;
    unit.name = element.required_text("unit");
    unit.has_base = false;
    element.each_child("DisplayUnitDefinition", [&](const Element& display) {
      unit.display_units.push_back(
          {display.required_text("displayUnit"), display.real("gain").value_or(1), display.real("offset").value_or(0)});
    });
    result_.units.push_back(std::move(unit));
  }

  void read_type(const Element& element) {
    TypeDefinition type;
    type.name = element.required_text("name");
    type.text = element.text("description");
    element.each_child([&](const Element& details) {
      const auto* const word = std::ranges::find(kTypeElements, details.name());
      if (word == std::end(kTypeElements)) return;
      type.type = static_cast<Type>(word - std::begin(kTypeElements));
      read_quantities(details, type);
      details.each_child("Item", [&](const Element& item) {  // the values of FMI 1.0 items are 1, 2, 3 and so on
        const auto value = static_cast<std::int64_t>(type.items.size()) + 1;
        type.items.push_back({item.required_text("name"), value, item.text("description")});
      });
    });
    types_.add(element, std::move(type), result_.types);
  }

  /// Returns false and adds a notice if an earlier variable has the same name. Public FMUs of FMI 1.0 have internal
  /// variables with equal names.
  bool is_first_of_its_name(const Element& element) {
    const auto name = element.required_text("name");
    if (names_.insert(name).second) return true;
    result_.structure_faults.push_back(
        element.located(fmt::format("an earlier variable also has the name \"{}\"", name)));
    return false;
  }

  void read_variable(const Element& element) {
    Variable& variable = result_.variables.emplace_back();
    variable.name = element.text("name");
    element.required_text("valueReference");
    variable.value_reference = *element.number<std::uint32_t>("valueReference", "a whole number of 32 bits");
    variable.text = element.text("description");

    const auto [type, details] = type_child(element);
    variable.type = type;
    variable.start = read_start(details, type);
    read_role(element, variable);
    if (variable.causality == Causality::output) outputs_.emplace_back(result_.variables.size() - 1, element);
    if (variable.initial && !std::holds_alternative<std::monostate>(variable.start))
      variable.initial = details.flag("fixed", true) ? Initial::exact : Initial::approx;

    variable.declared_type = details.text("declaredType");
    read_quantities(details, variable);
    variable.relative_quantity = details.flag("relativeQuantity", false);
    types_.apply(element, result_.types, variable);
    if (element.word<Alias>("alias", fmi::kAliasWords1) != Alias::negated) return;
    if (type == Type::string || type == Type::enumeration)
      element.fail(fmt::format("\"{}\" is a negated alias, but a value of type {} has no negative", variable.name,
                               to_string(type)));
    variable.negated_reference = variable.value_reference;
  }

  /// Sets causality, variability and initial in the terms of FMI 2.0.
  static void read_role(const Element& element, Variable& variable) {
    const auto causality = element.word<Causality1>("causality", fmi::kCausalityWords1).value_or(Causality1::internal);
    const auto variability =
        element.word<Variability1>("variability", fmi::kVariabilityWords1).value_or(Variability1::continuous);
    if (causality == Causality1::output) variable.causality = Causality::output;
    if (causality == Causality1::input) variable.causality = Causality::input;
    switch (variability) {
      case Variability1::constant:
        variable.variability = Variability::constant;
        break;
      case Variability1::parameter:
        variable.variability = Variability::fixed;
        if (causality == Causality1::output) break;
        variable.causality = std::holds_alternative<std::monostate>(variable.start) ? Causality::calculated_parameter
                                                                                    : Causality::parameter;
        break;
      case Variability1::discrete:
        variable.variability = Variability::discrete;
        break;
      case Variability1::continuous:
        variable.variability = variable.type == Type::real ? Variability::continuous : Variability::discrete;
        break;
    }
    variable.initial = default_initial(variable.causality, variable.variability);
  }

  /// Gives each negated alias a unique value reference. In FMI 1.0, a negated alias has the value reference of its
  /// base.
  void give_negated_aliases_their_references() {
    std::unordered_set<std::uint32_t> used;
    for (const auto& variable : result_.variables) used.insert(variable.value_reference);
    auto next = std::numeric_limits<std::uint32_t>::max() - 1;  // the largest means "undefined" in FMI 1.0
    for (auto& variable : result_.variables) {
      if (!variable.negated_reference) continue;
      while (used.contains(next)) --next;
      variable.value_reference = next--;
    }
  }

  /// Reads an output. Without <DirectDependency>, the output may depend on all inputs.
  void read_output(std::size_t variable, const Element& element) {
    Unknown unknown;
    unknown.variable = variable;
    if (const Element list = element.child("DirectDependency")) {
      unknown.dependencies.emplace();
      list.each_child("Name", [&](const Element& name) { read_dependency(name, *unknown.dependencies); });
    }
    result_.outputs.push_back(std::move(unknown));
  }

  void read_dependency(const Element& element, std::vector<std::size_t>& dependencies) {
    const std::string name(trimmed(element.content()));
    if (const auto* const variable = result_.find(name)) {
      dependencies.push_back(static_cast<std::size_t>(variable - result_.variables.data()));
    } else {
      result_.structure_faults.push_back(
          element.located(fmt::format("an output depends on \"{}\", which is not a variable", name)));
    }
  }

  Element root_;
  ModelDescription result_;
  std::vector<std::pair<std::size_t, Element>> outputs_;  // index and element of the variable
  std::unordered_set<std::string> names_;
  DeclaredTypes types_;
};

}  // namespace

ModelDescription read_fmi1(const Document& document) {
  return Fmi1Reader(document).read();
}

}  // namespace mebots::modeldesc
