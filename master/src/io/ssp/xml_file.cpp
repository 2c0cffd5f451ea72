// SPDX-License-Identifier: Apache-2.0
#include "xml_file.hpp"

#include "files.hpp"
#include "mebots/input_error.hpp"
#include "mebots/modeldesc/xml.hpp"
#include "mebots/parsed_number.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <set>
#include <sstream>

namespace mebots::master::ssp {

XmlFile::XmlFile(std::string_view bytes, std::string name) : name_(std::move(name)) {
  try {
    text_ = modeldesc::xml_as_utf8(bytes, name_);
    modeldesc::parse_xml(document_, text_, name_);
  } catch (const Error& error) {
    throw InputError(error.code(), error.what());
  }
}

std::string XmlFile::place(pugi::xml_node node) const {
  return fmt::format("{}, line {}", name_, modeldesc::line_of(text_, node.offset_debug()));
}

void XmlFile::fail(pugi::xml_node node, const std::string& what) const {
  throw InputError(ErrorCode::syntax_error, fmt::format("{}, <{}>: {}", place(node), local_name(node), what));
}

std::string XmlFile::required(pugi::xml_node node, const char* attribute) const {
  const auto found = node.attribute(attribute);
  if (!found) fail(node, fmt::format("the attribute {} is missing", attribute));
  return found.value();
}

double XmlFile::number(pugi::xml_node node, const char* attribute, double fallback) const {
  const auto found = node.attribute(attribute);
  if (!found) return fallback;
  const auto value = parse_number(found.value());
  if (!value)
    fail(node, fmt::format("the attribute {} is \"{}\", but a finite number is expected", attribute, found.value()));
  return *value;
}

bool XmlFile::flag(pugi::xml_node node, const char* attribute, bool fallback) const {
  const auto found = node.attribute(attribute);
  if (!found) return fallback;
  if (const auto value = parse_flag(found.value())) return *value;
  fail(node, fmt::format("the attribute {} is \"{}\", but true or false is expected", attribute, found.value()));
}

std::string_view local_name(pugi::xml_node node) {
  const std::string_view name = node.name();
  return name.substr(name.find(':') + 1);
}

pugi::xml_node child(pugi::xml_node node, std::string_view name) {
  return node.find_child([&](pugi::xml_node one) { return local_name(one) == name; });
}

std::vector<pugi::xml_node> children(pugi::xml_node node, std::string_view name) {
  std::vector<pugi::xml_node> result;
  for (const auto one : node.children()) {
    if (local_name(one) == name) result.push_back(one);
  }
  return result;
}

std::optional<double> parse_number(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const auto first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return std::nullopt;
  text = text.substr(first, text.find_last_not_of(kSpace) - first + 1);
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto value = parsed_number<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<bool> parse_flag(std::string_view text) {
  if (text == "true" || text == "1") return true;
  if (text == "false" || text == "0") return false;
  return std::nullopt;
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

namespace {

modeldesc::Unit read_unit_definition(const XmlFile& file, pugi::xml_node node) {
  modeldesc::Unit unit;
  unit.name = file.required(node, "name");
  const auto base = child(node, "BaseUnit");
  unit.has_base = !base.empty();
  for (std::size_t i = 0; i < modeldesc::kBaseUnits.size(); ++i) {
    const auto exponent = file.number(base, std::string(modeldesc::kBaseUnits[i]).c_str(), 0);
    constexpr double kLargest = 1000;
    if (exponent != std::trunc(exponent) || std::abs(exponent) > kLargest) {
      file.fail(base, fmt::format("the exponent of {} is {}, but a whole number is expected", modeldesc::kBaseUnits[i],
                                  exponent));
    }
    unit.exponents[i] = static_cast<int>(exponent);
  }
  unit.factor = file.number(base, "factor", 1);
  unit.offset = file.number(base, "offset", 0);
  if (!std::isnormal(unit.factor)) file.fail(base, fmt::format("a unit's factor cannot be {}", unit.factor));
  return unit;
}

std::vector<modeldesc::EnumerationItem> read_items(const XmlFile& file, pugi::xml_node node) {
  std::vector<modeldesc::EnumerationItem> items;
  for (const auto item : children(node, "Item")) {
    const std::string_view text = item.attribute("value").as_string("0");
    const auto value = parsed_number<std::int64_t>(text);
    if (!value) file.fail(item, fmt::format("the value \"{}\" is not a whole number that fits into 64 bits", text));
    items.push_back({file.required(item, "name"), *value, ""});
  }
  return items;
}

ValueMap read_map(const XmlFile& file, pugi::xml_node node, ValueMap::Kind kind) {
  ValueMap map{kind, {}};
  std::set<std::string> sources;
  for (const auto entry : children(node, "MapEntry")) {
    auto source = file.required(entry, "source");
    if (!sources.insert(source).second) {
      file.fail(entry, fmt::format("the map has two entries for \"{}\"", source));
    }
    map.entries.emplace_back(std::move(source), file.required(entry, "target"));
  }
  return map;
}

}  // namespace

std::filesystem::path resolve_uri(const Source& source, const XmlFile& file, pugi::xml_node node,
                                  const std::string& uri) {
  const auto named = parse_file_uri(uri);
  if (!named) file.fail(node, fmt::format("the source \"{}\" is absolute; only files of the SSP can be used", uri));
  if (named->has_backslashes) {
    source.notices.push_back(
        fmt::format("{}: the backslashes of the source \"{}\" are read as slashes", file.place(node), uri));
  }
  const bool is_open = source.files.is_open();
  if (named->path.is_absolute() && !is_open) {
    file.fail(node, fmt::format("the source \"{}\" is absolute; only files inside the SSP can be used", uri));
  }
  auto path = (source.base / named->path).lexically_normal();
  if (path.empty() || (*path.begin() == ".." && !is_open)) {
    file.fail(node, fmt::format("the source \"{}\" is not inside the SSP", uri));
  }
  if (!source.files.holds(path)) file.fail(node, fmt::format("the SSP contains no file \"{}\"", uri));
  return path;
}

Definitions read_definitions(const XmlFile& file, pugi::xml_node root) {
  Definitions definitions;
  for (const auto node : children(child(root, "Units"), "Unit")) {
    auto unit = read_unit_definition(file, node);
    definitions.units.insert_or_assign(unit.name, unit);
  }
  for (const auto node : children(child(root, "Enumerations"), "Enumeration")) {
    definitions.enumerations.insert_or_assign(file.required(node, "name"), read_items(file, node));
  }
  return definitions;
}

std::optional<modeldesc::Unit> read_unit(pugi::xml_node type, const Definitions& definitions) {
  const std::string name = type.attribute("unit").value();
  if (name.empty()) return std::nullopt;
  const auto defined = definitions.units.find(name);
  if (defined != definitions.units.end()) return defined->second;
  modeldesc::Unit unit;
  unit.name = name;
  unit.has_base = false;
  return unit;
}

Transformation read_transformation(const XmlFile& file, pugi::xml_node node) {
  Transformation result;
  result.convert_units = !file.flag(node, "suppressUnitConversion", false);
  result.place = file.place(node);
  if (const auto linear = child(node, "LinearTransformation")) {
    const Linear read{file.number(linear, "factor", 1), file.number(linear, "offset", 0)};
    if (read.factor != 1 || read.offset != 0) result.what = read;
    return result;
  }
  for (const auto& [name, kind] : {std::pair("BooleanMappingTransformation", ValueMap::Kind::boolean),
                                   std::pair("IntegerMappingTransformation", ValueMap::Kind::integer),
                                   std::pair("EnumerationMappingTransformation", ValueMap::Kind::enumeration)}) {
    if (const auto map = child(node, name)) result.what = read_map(file, map, kind);
  }
  return result;
}

}  // namespace mebots::master::ssp
