// SPDX-License-Identifier: Apache-2.0
#include "mebots/modeldesc/xml.hpp"
#include "xml_writer.hpp"

#include <fmt/format.h>
#include <pugixml.hpp>

namespace mebots::modeldesc {
namespace {

void write_co_simulation(Element root, const CoSimulation& flags) {
  Element element = root.child("CoSimulation");
  element.text("modelIdentifier", flags.model_identifier)
      .flag_if("needsExecutionTool", flags.needs_execution_tool)
      .flag_if("canHandleVariableCommunicationStepSize", flags.can_handle_variable_communication_step_size)
      .flag_if("canInterpolateInputs", flags.can_interpolate_inputs);
  if (flags.max_output_derivative_order != 0)
    element.text("maxOutputDerivativeOrder", std::to_string(flags.max_output_derivative_order));
  element.flag_if("canRunAsynchronuously", flags.can_run_asynchronuously)
      .flag_if("canBeInstantiatedOnlyOncePerProcess", flags.can_be_instantiated_only_once_per_process)
      .flag_if("canNotUseMemoryManagementFunctions", flags.can_not_use_memory_management_functions)
      .flag_if("canGetAndSetFMUstate", flags.can_get_and_set_fmu_state)
      .flag_if("canSerializeFMUstate", flags.can_serialize_fmu_state)
      .flag_if("providesDirectionalDerivative", flags.provides_directional_derivative);
  if (flags.source_files.empty()) return;
  Element files = element.child("SourceFiles");
  for (const std::string& file : flags.source_files) files.child("File").text("name", file);
}

/// Returns a limit as text. For types with whole values, the text is a whole number.
std::string limit_text(double value, Type type) {
  return type == Type::real ? number_text(value) : fmt::format("{}", static_cast<std::int64_t>(value));
}

template <typename Source>
void write_limits(Element element, const Source& source, Type type) {
  if (source.min) element.text("min", limit_text(*source.min, type));
  if (source.max) element.text("max", limit_text(*source.max, type));
  if (type == Type::real) element.number_if("nominal", source.nominal);
}

void write_types(Element root, const std::vector<TypeDefinition>& types) {
  if (types.empty()) return;
  Element definitions = root.child("TypeDefinitions");
  for (const TypeDefinition& type : types) {
    Element simple = definitions.child("SimpleType").text("name", type.name).text_if("description", type.text);
    Element element = simple.child(std::string(to_string(type.type)).c_str()).text_if("quantity", type.quantity);
    if (type.type == Type::real) element.text_if("unit", type.unit).text_if("displayUnit", type.display_unit);
    if (type.type == Type::real || type.type == Type::integer) write_limits(element, type, type.type);
    for (const EnumerationItem& item : type.items)
      element.child("Item")
          .text("name", item.name)
          .text("value", std::to_string(item.value))
          .text_if("description", item.text);
  }
}

void write_start(Element element, const Value& start) {
  if (const auto* real = std::get_if<double>(&start)) element.text("start", number_text(*real));
  if (const auto* integer = std::get_if<std::int64_t>(&start)) element.text("start", std::to_string(*integer));
  if (const auto* boolean = std::get_if<bool>(&start)) element.text("start", *boolean ? "true" : "false");
  if (const auto* text = std::get_if<std::string>(&start)) element.text("start", *text);
}

void write_variable(Element variables, const Variable& variable, std::size_t index) {
  variables.comment(fmt::format(" {} ", index + 1).c_str());
  Element scalar = variables.child("ScalarVariable")
                       .text("name", variable.name)
                       .text("valueReference", std::to_string(variable.value_reference))
                       .text_if("description", variable.text)
                       .text("causality", std::string(to_string(variable.causality)))
                       .text("variability", std::string(to_string(variable.variability)));
  if (variable.initial) scalar.text("initial", std::string(to_string(*variable.initial)));
  if (!variable.can_handle_multiple_set_per_time_instant) scalar.text("canHandleMultipleSetPerTimeInstant", "false");

  Element element = scalar.child(std::string(to_string(variable.type)).c_str());
  element.text_if("declaredType", variable.declared_type).text_if("quantity", variable.quantity);
  if (variable.type == Type::real) element.text_if("unit", variable.unit).text_if("displayUnit", variable.display_unit);
  element.flag_if("relativeQuantity", variable.relative_quantity);
  // Only numeric types have limits as attributes.
  if (variable.type == Type::real || variable.type == Type::integer) write_limits(element, variable, variable.type);
  write_start(element, variable.start);
  if (variable.derivative_of) element.text("derivative", std::to_string(*variable.derivative_of + 1));
  element.flag_if("reinit", variable.reinit);

  if (variable.osmp) {
    scalar.child("Annotations")
        .child("Tool")
        .text("name", "net.pmsf.osmp")
        .child("osmp:osmp-binary-variable")
        .text("xmlns:osmp", "http://xsd.pmsf.net/OSISensorModelPackaging")
        .text("name", variable.osmp->name)
        .text("role", variable.osmp->role)
        .text("mime-type", variable.osmp->mime_type);
  }
}

void write_unknowns(Element structure, const char* name, const std::vector<Unknown>& unknowns) {
  if (unknowns.empty()) return;
  Element list = structure.child(name);
  for (const Unknown& unknown : unknowns) {
    Element element = list.child("Unknown").text("index", std::to_string(unknown.variable + 1));
    if (!unknown.dependencies) continue;
    std::string indices;
    for (const std::size_t dependency : *unknown.dependencies)
      indices += (indices.empty() ? "" : " ") + std::to_string(dependency + 1);
    element.text("dependencies", indices);
    if (unknown.dependency_kinds.empty()) continue;
    std::string kinds;
    for (const std::string& kind : unknown.dependency_kinds) kinds += (kinds.empty() ? "" : " ") + kind;
    element.text("dependenciesKind", kinds);
  }
}

}  // namespace

std::string write_xml(const ModelDescription& description) {
  XmlText text("fmiModelDescription");
  Element root = text.root();
  write_identity(root, description, description.fmi_version.c_str(), "guid", description.guid);
  root.text_if("generationDateAndTime", description.generation_date_and_time)
      .text("variableNamingConvention", description.structured_names ? "structured" : "flat");
  if (description.number_of_event_indicators != 0)
    root.text("numberOfEventIndicators", std::to_string(description.number_of_event_indicators));
  if (description.co_simulation) write_co_simulation(root, *description.co_simulation);
  write_units(root, description.units);
  write_types(root, description.types);
  write_log_categories(root, description.log_categories);
  write_default_experiment(root, description.default_experiment);
  Element variables = root.child("ModelVariables");
  for (std::size_t i = 0; i < description.variables.size(); ++i) write_variable(variables, description.variables[i], i);
  Element structure = root.child("ModelStructure");
  write_unknowns(structure, "Outputs", description.outputs);
  write_unknowns(structure, "Derivatives", description.derivatives);
  write_unknowns(structure, "InitialUnknowns", description.initial_unknowns);
  return text.str();
}

}  // namespace mebots::modeldesc
