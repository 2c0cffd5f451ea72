// SPDX-License-Identifier: Apache-2.0
#include "xml_element.hpp"

#include <cstdint>
#include <unordered_map>
#include <unordered_set>

namespace mebots::modeldesc {
namespace {

class Fmi2Reader {
 public:
  explicit Fmi2Reader(const Document& document) : root_(document, document.root()) {}

  ModelDescription read() {
    read_root();
    read_implementations();
    read_common(root_, result_);
    root_.child("TypeDefinitions").each_child("SimpleType", [&](const Element& e) { read_type(e); });
    Element variables = root_.child("ModelVariables");
    if (!variables) root_.fail("the element <ModelVariables> is missing");
    result_.variables.reserve(variables.count_children("ScalarVariable"));
    names_.reserve(result_.variables.capacity());
    variables.consume_children("ScalarVariable", [&](const Element& e) {
      read_variable(e);
      if (result_.variables.size() % kVariablesPerTrim == 0) release_free_memory();
    });
    check_derivatives(variables);
    const Element structure = root_.child("ModelStructure");
    if (!structure) root_.fail("the element <ModelStructure> is missing");
    result_.outputs = read_unknowns(structure.child("Outputs"));
    result_.derivatives = read_unknowns(structure.child("Derivatives"));
    result_.initial_unknowns = read_unknowns(structure.child("InitialUnknowns"));
    result_.index_names();
    return std::move(result_);
  }

 private:
  void read_root() {
    result_.fmi_version = "2.0";
    read_head(root_, "guid", result_);
    result_.number_of_event_indicators = count(root_, "numberOfEventIndicators");
  }

  static std::uint32_t count(const Element& element, const char* name) {
    return element.number<std::uint32_t>(name, "a count").value_or(0);
  }

  void read_implementations() {
    const Element model_exchange = root_.child("ModelExchange");
    const Element co_simulation = root_.child("CoSimulation");
    if (!co_simulation && !model_exchange) root_.fail("there is neither <CoSimulation> nor <ModelExchange>");
    if (model_exchange) read_model_exchange(model_exchange);
    if (co_simulation) read_co_simulation(co_simulation);
  }

  void read_model_exchange(const Element& element) {
    ModelExchange& flags = result_.model_exchange.emplace();
    read_implementation(element, flags);
    flags.completed_integrator_step_not_needed = element.flag("completedIntegratorStepNotNeeded", false);
  }

  void read_co_simulation(const Element& element) {
    CoSimulation& flags = result_.co_simulation.emplace();
    read_implementation(element, flags);
    flags.can_handle_variable_communication_step_size = element.flag("canHandleVariableCommunicationStepSize", false);
    flags.can_interpolate_inputs = element.flag("canInterpolateInputs", false);
    flags.max_output_derivative_order = count(element, "maxOutputDerivativeOrder");
    flags.can_run_asynchronuously = element.flag("canRunAsynchronuously", false);
  }

  static void read_implementation(const Element& element, Implementation& flags) {
    flags.model_identifier = model_identifier(element);
    flags.needs_execution_tool = element.flag("needsExecutionTool", false);
    flags.can_be_instantiated_only_once_per_process = element.flag("canBeInstantiatedOnlyOncePerProcess", false);
    flags.can_not_use_memory_management_functions = element.flag("canNotUseMemoryManagementFunctions", false);
    flags.can_get_and_set_fmu_state = element.flag("canGetAndSetFMUstate", false);
    flags.can_serialize_fmu_state = element.flag("canSerializeFMUstate", false);
    flags.provides_directional_derivative = element.flag("providesDirectionalDerivative", false);
    element.child("SourceFiles").each_child("File", [&](const Element& file) {
      flags.source_files.push_back(file.required_text("name"));
    });
  }

  void read_type(const Element& element) {
    TypeDefinition type;
    type.name = element.required_text("name");
    type.text = element.text("description");
    const auto [kind, details] = type_child(element);
    type.type = kind;
    read_quantities(details, type);
    details.each_child("Item", [&](const Element& item) {
      item.required_text("value");
      type.items.push_back({item.required_text("name"),
                            *item.number<std::int32_t>("value", "a whole number of 32 bits"),
                            item.text("description")});
    });
    types_.add(element, std::move(type), result_.types);
  }

  void read_variable(const Element& element) {
    Variable& variable = result_.variables.emplace_back();
    variable.name = element.required_text("name");
    if (!names_.insert(variable.name).second)
      element.fail(fmt::format("two variables have the name \"{}\"", variable.name));
    element.required_text("valueReference");
    variable.value_reference = *element.number<std::uint32_t>("valueReference", "a whole number of 32 bits");
    variable.text = element.text("description");
    variable.can_handle_multiple_set_per_time_instant = element.flag("canHandleMultipleSetPerTimeInstant", true);

    const auto [type, details] = type_child(element);
    variable.type = type;
    variable.causality = element.word<Causality>("causality", fmi::kCausalityWords2).value_or(Causality::local);
    variable.variability =
        element.word<Variability>("variability", fmi::kVariabilityWords).value_or(default_variability(variable));
    if (variable.variability == Variability::continuous && type != Type::real)
      element.fail(fmt::format("\"{}\" is of type {}, so it cannot be continuous", variable.name, to_string(type)));
    variable.initial = element.word<Initial>("initial", fmi::kInitialWords);
    if (!variable.initial) variable.initial = default_initial(variable.causality, variable.variability);

    variable.declared_type = details.text("declaredType");
    read_quantities(details, variable);
    variable.relative_quantity = details.flag("relativeQuantity", false);
    variable.reinit = details.flag("reinit", false);
    variable.start = read_start(details, type);
    if (const auto derivative = details.number<std::uint32_t>("derivative", "the index of a variable")) {
      if (*derivative == 0) details.fail("derivative is 0, but indices count from 1");
      variable.derivative_of = *derivative - 1;
    }
    types_.apply(element, result_.types, variable);
    read_osmp(element, variable);
  }

  static Variability default_variability(const Variable& variable) {
    if (variable.causality == Causality::parameter || variable.causality == Causality::calculated_parameter)
      return Variability::fixed;
    return variable.type == Type::real ? Variability::continuous : Variability::discrete;
  }

  static void read_osmp(const Element& element, Variable& variable) {
    element.child("Annotations").each_child("Tool", [&](const Element& tool) {
      if (tool.text("name") != "net.pmsf.osmp") return;
      tool.each_child([&](const Element& part) {
        const std::string_view name = part.name();
        // Ignores the prefix of the XML namespace, which each file chooses.
        if (name.substr(name.find(':') + 1) != "osmp-binary-variable") return;
        variable.osmp = OsmpPart{part.required_text("name"), part.required_text("role"), part.text("mime-type")};
      });
    });
  }

  void check_derivatives(const Element& variables) const {
    for (const Variable& variable : result_.variables)
      if (variable.derivative_of && *variable.derivative_of >= result_.variables.size())
        variables.fail(fmt::format("\"{}\" is the derivative of variable {}, but there are only {}", variable.name,
                                   *variable.derivative_of + 1, result_.variables.size()));
  }

  /// Returns the index of the variable with this number in ModelStructure. Reports a wrong number without an error:
  /// some tools write 0, and an FMU also runs without its ModelStructure.
  std::optional<std::size_t> index(const Element& element, std::string_view text) {
    const auto value = parse_number<std::size_t>(text);
    if (!value) element.fail(fmt::format("\"{}\" is not an index of a variable", text));
    if (*value != 0 && *value <= result_.variables.size()) return *value - 1;
    result_.structure_faults.push_back(element.located(
        fmt::format("\"{}\" is not an index of a variable; they go from 1 to {}", text, result_.variables.size())));
    return std::nullopt;
  }

  std::vector<Unknown> read_unknowns(const Element& list) {
    std::vector<Unknown> unknowns;
    list.each_child("Unknown", [&](const Element& element) {
      const auto variable = index(element, element.required_text("index"));
      auto unknown = read_dependencies(element, [&](std::string_view word) { return index(element, word); });
      if (!variable) return;
      unknown.variable = *variable;
      unknowns.push_back(std::move(unknown));
    });
    return unknowns;
  }

  Element root_;
  ModelDescription result_;
  std::unordered_set<std::string_view> names_;  // names in the variables, whose addresses do not change
  DeclaredTypes types_;
};

}  // namespace

ModelDescription read_fmi2(const Document& document) {
  return Fmi2Reader(document).read();
}

}  // namespace mebots::modeldesc
