// SPDX-License-Identifier: Apache-2.0
// Writes modelDescription.xml, terminalsAndIcons.xml and buildDescription.xml of FMI 3.0 from the same description as
// for FMI 2.0.
#include "fmi3_variables.hpp"
#include "generate.hpp"
#include "xml_writer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

namespace mebots::modeldesc {
namespace {

/// Compiler options for the sources. The compiler must round after every operation, and must not replace the
/// mathematical functions of the sources.
constexpr const char* kSourceOptions = "-ffp-contract=off -fno-builtin";

std::string value_text(const Value& value) {
  if (const auto* real = std::get_if<double>(&value)) return number_text(*real);
  if (const auto* boolean = std::get_if<bool>(&value)) return *boolean ? "true" : "false";
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  return std::to_string(whole_number_of(value));
}

void write_enumeration_types(Element root, const std::vector<TypeDefinition>& types) {
  if (types.empty()) return;
  Element definitions = root.child("TypeDefinitions");
  for (const TypeDefinition& type : types) {
    Element element = definitions.child("EnumerationType").text("name", type.name);
    for (const EnumerationItem& item : type.items)
      element.child("Item").text("name", item.name).text("value", std::to_string(item.value));
  }
}

void write_start(Element element, const Fmi3Variable& variable) {
  const Field& field = *variable.field;
  if (field.type == FieldType::binary && field.causality == Causality::input) {
    for (std::size_t i = 0; i < variable.start_elements; ++i) element.child("Start").text("value", "");
    return;
  }
  if (field.starts.empty()) return;
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < variable.start_elements; ++i)
    texts.push_back(value_text(field.starts[(variable.first + i) % field.words]));
  if (field.type != FieldType::string) {
    element.text("start", fmt::format("{}", fmt::join(texts, " ")));
    return;
  }
  for (const std::string& text : texts) element.child("Start").text("value", text);
}

void write_limits(Element element, const Field& field) {
  if (field.type == FieldType::real) {
    element.number_if("min", field.min).number_if("max", field.max).number_if("nominal", field.nominal);
  } else if (field.type == FieldType::integer) {
    if (field.min) element.text("min", fmt::format("{}", static_cast<std::int64_t>(*field.min)));
    if (field.max) element.text("max", fmt::format("{}", static_cast<std::int64_t>(*field.max)));
  }
}

void write_variable(Element variables, const Fmi3Variable& variable) {
  const Field& field = *variable.field;
  const std::string causality =
      variable.is_structural ? "structuralParameter" : std::string(to_string(field.causality));
  Element element = variables.child(fmi3_type(variable))
                        .text("name", variable.name)
                        .text("valueReference", std::to_string(variable.value_reference))
                        .text_if("description", variable.text)
                        .text("causality", causality)
                        .text("variability", std::string(to_string(field.variability)))
                        .text_if("declaredType", field.enumeration)
                        .text_if("unit", field.unit)
                        .text_if("mimeType", field.mime_type);
  if (field.causality == Causality::output) element.text("initial", "calculated");
  write_limits(element, field);
  if (variable.size_reference)
    element.child("Dimension").text("valueReference", std::to_string(*variable.size_reference));
  const bool has_fixed_size = variable.copies > 1 ? variable.words > 1 : !variable.size_reference;
  if (variable.is_array && has_fixed_size) element.child("Dimension").text("start", std::to_string(variable.words));
  write_start(element, variable);
}

void write_variables(Element root, const std::vector<Fmi3Variable>& variables, std::size_t rows) {
  Element element = root.child("ModelVariables");
  element.child("Float64")
      .text("name", kTimeName)
      .text("valueReference", std::to_string(rows))
      .text("description", "Simulated time")
      .text("causality", "independent")
      .text("variability", "continuous");
  for (const Fmi3Variable& variable : variables) write_variable(element, variable);
}

/// Writes elements of <ModelStructure> for FMI 3.0. `unknowns` refer to variables of FMI 2.0, of which several may form
/// one variable of FMI 3.0.
void write_unknowns(Element structure, const char* name, const std::vector<Unknown>& unknowns,
                    const std::vector<Fmi3Variable>& variables) {
  const auto variable_of = [&](std::size_t row) {
    const auto after = std::ranges::upper_bound(variables, row, {}, &Fmi3Variable::value_reference);
    return std::prev(after)->value_reference;
  };
  for (const Unknown& unknown : unknowns) {
    const auto reference = variable_of(unknown.variable);
    if (reference != unknown.variable) continue;  // the first row represents all rows of a variable
    Element element = structure.child(name).text("valueReference", std::to_string(reference));
    if (!unknown.dependencies) continue;
    std::set<std::uint32_t> dependencies;
    for (const std::size_t row : *unknown.dependencies) dependencies.insert(variable_of(row));
    element.text("dependencies", fmt::format("{}", fmt::join(dependencies, " ")));
  }
}

std::string model_description_text(const ModelDescription& common, const std::vector<Fmi3Variable>& variables,
                                   const std::string& token) {
  XmlText text("fmiModelDescription");
  Element root = text.root();
  write_identity(root, common, "3.0", "instantiationToken", token);
  root.text("variableNamingConvention", "structured");
  root.child("CoSimulation")
      .text("modelIdentifier", common.co_simulation->model_identifier)
      .text("canHandleVariableCommunicationStepSize", "true")
      .text("canGetAndSetFMUState", "true")
      .text("canSerializeFMUState", "true");
  write_units(root, common.units);
  write_enumeration_types(root, common.types);
  write_log_categories(root, common.log_categories);
  write_default_experiment(root, common.default_experiment);
  write_variables(root, variables, common.variables.size());
  Element structure = root.child("ModelStructure");
  write_unknowns(structure, "Output", common.outputs, variables);
  write_unknowns(structure, "InitialUnknown", common.initial_unknowns, variables);
  return text.str();
}

void write_terminal(Element terminals, const Terminal& terminal, const Description& description,
                    const std::vector<Fmi3Variable>& variables) {
  Element element = terminals.child("Terminal")
                        .text("name", terminal.name)
                        .text("matchingRule", terminal.matching_rule)
                        .text("terminalKind", terminal.kind)
                        .text_if("description", terminal.text);
  for (const Terminal::Member& member : terminal.members) {
    const auto variable = std::ranges::find_if(variables, [&](const Fmi3Variable& v) {
      return v.field == &description.fields[member.field] && v.first == member.element;
    });
    element.child("TerminalMemberVariable")
        .text("variableName", variable->name)
        .text("memberName", member.name)
        .text("variableKind", "signal");
  }
}

}  // namespace

Fmi3Text write_fmi3_xml(const Description& description, const ModelDescription& common) {
  const auto variables = fmi3_variables(description);
  Fmi3Text text;
  text.token = token_of(model_description_text(common, variables, ""));
  text.xml = model_description_text(common, variables, text.token);
  return text;
}

std::string write_build_description(const std::string& model_identifier, const std::vector<std::string>& sources) {
  XmlText text("fmiBuildDescription");
  Element set = text.root()
                    .text("fmiVersion", "3.0")
                    .child("BuildConfiguration")
                    .text("modelIdentifier", model_identifier)
                    .child("SourceFileSet")
                    .text("language", "C++20")
                    .text("compiler", "gcc")
                    .text("compilerOptions", kSourceOptions);
  for (const auto& file : sources) set.child("SourceFile").text("name", file);
  set.child("IncludeDirectory").text("name", ".");
  return text.str();
}

std::string write_terminals_and_icons(const Description& description, bool has_icon) {
  if (description.terminals.empty() && !has_icon) return {};
  XmlText text("fmiTerminalsAndIcons");
  Element root = text.root();
  root.text("fmiVersion", "3.0");
  if (has_icon) {
    const auto square = [](Element element) {
      return element.text("x1", "-100").text("y1", "-100").text("x2", "100").text("y2", "100");
    };
    Element picture = root.child("GraphicalRepresentation");
    square(picture.child("CoordinateSystem")).text("suggestedScalingFactorTo_mm", "0.1");
    square(picture.child("Icon"));
  }
  if (!description.terminals.empty()) {
    const auto variables = fmi3_variables(description);
    Element terminals = root.child("Terminals");
    for (const Terminal& terminal : description.terminals) write_terminal(terminals, terminal, description, variables);
  }
  return text.str();
}

}  // namespace mebots::modeldesc
