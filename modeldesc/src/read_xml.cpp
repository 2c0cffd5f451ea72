// SPDX-License-Identifier: Apache-2.0
#include "xml_element.hpp"

#include <malloc.h>

#include <cmath>
#include <fstream>
#include <set>

namespace mebots::modeldesc {

std::optional<Initial> default_initial(Causality causality, Variability variability) {
  switch (causality) {
    case Causality::parameter:
    case Causality::structural_parameter:
      return Initial::exact;
    case Causality::input:
    case Causality::independent:
      return std::nullopt;
    case Causality::calculated_parameter:
    case Causality::output:
    case Causality::local:
    case Causality::dependent:
      break;
  }
  return variability == Variability::constant ? Initial::exact : Initial::calculated;
}

void release_free_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

namespace {

Unit read_unit(const Element& element) {
  Unit unit;
  unit.name = element.required_text("name");
  const Element base = element.child("BaseUnit");
  unit.has_base = static_cast<bool>(base);
  if (base) {
    for (std::size_t i = 0; i < kBaseUnits.size(); ++i)
      unit.exponents[i] = base.number<int>(std::string(kBaseUnits[i]).c_str(), "a whole exponent").value_or(0);
    unit.factor = base.real("factor").value_or(1);
    unit.offset = base.real("offset").value_or(0);
    if (unit.factor == 0 || !std::isfinite(unit.factor) || !std::isfinite(unit.offset))
      base.fail(fmt::format("the unit \"{}\" has the factor {} and the offset {}, which define no conversion",
                            unit.name, unit.factor, unit.offset));
  }
  element.each_child("DisplayUnit", [&](const Element& display) {
    unit.display_units.push_back(
        {display.required_text("name"), display.real("factor").value_or(1), display.real("offset").value_or(0)});
  });
  return unit;
}

}  // namespace

std::string model_identifier(const Element& element) {
  auto text = element.required_text("modelIdentifier");
  if (text.empty() || text.find_first_of("/\\") != std::string::npos)
    element.fail(fmt::format("modelIdentifier is \"{}\", which is not a C name", text));
  return text;
}

void read_head(const Element& root, const char* guid, ModelDescription& result) {
  result.model_name = root.required_text("modelName");
  result.guid = root.required_text(guid);
  result.text = root.text("description");
  result.author = root.text("author");
  result.version = root.text("version");
  result.copyright = root.text("copyright");
  result.license = root.text("license");
  result.generation_tool = root.text("generationTool");
  result.generation_date_and_time = root.text("generationDateAndTime");
  const std::string naming = root.text("variableNamingConvention");
  if (!naming.empty() && naming != "flat" && naming != "structured")
    root.fail(fmt::format("variableNamingConvention is \"{}\", but flat or structured is expected", naming));
  result.structured_names = naming == "structured";
}

void read_common(const Element& root, ModelDescription& result) {
  std::set<std::string> names;
  root.child("UnitDefinitions").each_child("Unit", [&](const Element& element) {
    result.units.push_back(read_unit(element));
    const auto& name = result.units.back().name;
    if (!names.insert(name).second) element.fail(fmt::format("the unit \"{}\" is defined twice", name));
  });
  root.child("LogCategories").each_child("Category", [&](const Element& element) {
    result.log_categories.push_back({element.required_text("name"), element.text("description")});
  });
  if (const Element experiment = root.child("DefaultExperiment"))
    result.default_experiment = {experiment.real("startTime"), experiment.real("stopTime"),
                                 experiment.real("tolerance"), experiment.real("stepSize")};
}

std::pair<Type, Element> type_child(const Element& variable) {
  std::optional<std::pair<Type, Element>> found;
  variable.each_child([&](const Element& child) {
    const auto* const word = std::ranges::find(fmi::kTypeWords2, child.name());
    if (word == std::end(fmi::kTypeWords2)) return;
    if (found) child.fail(fmt::format("\"{}\" has two types", variable.text("name")));
    found = {static_cast<Type>(word - std::begin(fmi::kTypeWords2)), child};
  });
  if (!found)
    variable.fail(
        fmt::format("\"{}\" has no type: one of <Real>, <Integer>, <Boolean>, <String>, <Enumeration> is expected",
                    variable.text("name")));
  return *found;
}

Value read_start(const Element& details, Type type) {
  if (!details.has("start")) return {};
  if (type == Type::real) return *details.real("start");
  if (type == Type::boolean) return *details.parse_flag("start");
  if (type == Type::string) return details.text("start");
  return std::int64_t{*details.number<std::int32_t>("start", "a whole number of 32 bits")};
}

void DeclaredTypes::add(const Element& element, TypeDefinition type, std::vector<TypeDefinition>& types) {
  if (!places_.emplace(type.name, types.size()).second)
    element.fail(fmt::format("the type \"{}\" is defined twice", type.name));
  types.push_back(std::move(type));
}

void DeclaredTypes::apply(const Element& element, const std::vector<TypeDefinition>& types, Variable& variable) const {
  if (variable.declared_type.empty()) return;
  const auto known = places_.find(variable.declared_type);
  if (known == places_.end())
    element.fail(fmt::format("\"{}\" is of declared type \"{}\", which <TypeDefinitions> does not define",
                             variable.name, variable.declared_type));
  const TypeDefinition& type = types[known->second];
  if (type.type != variable.type)
    element.fail(fmt::format("\"{}\" is of type {}, but its declared type \"{}\" is of type {}", variable.name,
                             to_string(variable.type), type.name, to_string(type.type)));
  if (variable.quantity.empty()) variable.quantity = type.quantity;
  if (variable.unit.empty()) variable.unit = type.unit;
  if (variable.display_unit.empty()) variable.display_unit = type.display_unit;
  if (!variable.min) variable.min = type.min;
  if (!variable.max) variable.max = type.max;
  if (!variable.nominal) variable.nominal = type.nominal;
}

namespace {

ModelDescription read_utf8(std::string text, std::string_view source) {
  const Document document(text, source);
  std::string().swap(text);  // frees the text, because the document has a copy
  const Element root(document, document.root());
  if (root.name() != "fmiModelDescription") root.fail("the root element must be <fmiModelDescription>");
  const auto version = root.required_text("fmiVersion");
  if (version == "1.0") return read_fmi1(document);
  if (version == "2.0") return read_fmi2(document);
  if (version == "3.0" || version.starts_with("3.0.") || version.starts_with("3.0-")) return read_fmi3(document);
  root.fail(fmt::format("the FMU is of FMI version {}; only 1.0, 2.0 and 3.0 can be used", version));
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw Error(
        ErrorCode::file_not_found,
        fmt::format("{}: cannot be opened; modelDescription.xml must be at the root of the archive", file.string()));
  }
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

}  // namespace

ModelDescription read_xml_text(std::string_view text, std::string_view source) {
  return read_utf8(xml_as_utf8(text, source), source);
}

ModelDescription read_xml(const std::filesystem::path& file) {
  return read_utf8(xml_as_utf8(bytes_of(file), file.string()), file.string());
}

}  // namespace mebots::modeldesc
