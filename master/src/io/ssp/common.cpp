// SPDX-License-Identifier: Apache-2.0
#include "common.hpp"

#include "uri.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <set>

namespace mebots::master::ssp {
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
    const auto value = file.number(item, "value", 0);
    using Limits = std::numeric_limits<std::int32_t>;
    if (value != std::trunc(value) || value < Limits::min() || value > Limits::max()) {
      file.fail(item, fmt::format("the value {} is not a whole number of 32 bits", value));
    }
    items.push_back({file.required(item, "name"), static_cast<std::int32_t>(value), ""});
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
  if (!source.files.holds(path)) file.fail(node, fmt::format("the SSP holds no file \"{}\"", uri));
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
