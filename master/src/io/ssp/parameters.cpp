// SPDX-License-Identifier: Apache-2.0
#include "values.hpp"

#include "files.hpp"
#include "mebots/fmi/variable_kinds.hpp"
#include "mebots/hexadecimal.hpp"
#include "mebots/input_error.hpp"
#include "mebots/modeldesc/archive_reader.hpp"
#include "mebots/modeldesc/array_elements.hpp"
#include "mebots/parsed_number.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <numeric>

namespace mebots::master::ssp {
namespace {

using modeldesc::Type;

constexpr std::string_view kParameterSet = "application/x-ssp-parameter-set";
constexpr std::string_view kParameterMapping = "application/x-ssp-parameter-mapping";

/// An inline XML element (`own` is null), or the root element of a separate file, which `own` keeps in memory.
struct Part {
  const XmlFile* file;
  pugi::xml_node node;
  std::unique_ptr<XmlFile> own;
};

std::string read_from_fmu(const BindingContext& context, pugi::xml_node node, const std::string& uri) {
  const auto named = parse_file_uri(uri);
  const auto path = named ? named->path.lexically_normal() : std::filesystem::path();
  try {
    const auto archive = context.source.files.place(context.fmu);
    const modeldesc::ArchiveReader reader(modeldesc::open_zip(archive), archive.string());
    for (const auto& entry : reader.entries()) {
      if (entry.is_folder || std::filesystem::path(entry.name).lexically_normal() != path) continue;
      std::string bytes;
      reader.read(entry, [&](std::string_view part) { bytes += part; });
      return bytes;
    }
  } catch (const Error& error) {
    context.ssd.fail(node, error.what());
  }
  context.ssd.fail(node, fmt::format("the FMU {} contains no file \"{}\"", context.fmu.string(), uri));
}

std::string read_source(const BindingContext& context, pugi::xml_node node, const std::string& uri) {
  const auto base = std::string_view(node.attribute("sourceBase").as_string("SSD"));
  if (base == "SSD") return context.source.files.read(resolve_uri(context.source, context.ssd, node, uri));
  if (base != "component") {
    context.ssd.fail(node, fmt::format("sourceBase is \"{}\", but SSD or component is expected", base));
  }
  if (context.fmu.empty()) {
    context.ssd.fail(node, "sourceBase=\"component\" needs a component, and this is a system");
  }
  return read_from_fmu(context, node, uri);
}

Part part(const BindingContext& context, pugi::xml_node node, const char* inline_holder, std::string_view root_name) {
  if (const auto uri = node.attribute("source")) {
    auto own = std::make_unique<XmlFile>(read_source(context, node, uri.value()),
                                         fmt::format("{}: {}", context.source.archive, uri.value()));
    const auto root = own->root();
    if (local_name(root) != root_name) own->fail(root, fmt::format("the root element must be {}", root_name));
    const auto* raw = own.get();
    return {raw, root, std::move(own)};
  }
  const auto holder = inline_holder == nullptr ? node : child(node, inline_holder);
  const auto found = child(holder, root_name);
  if (!found) context.ssd.fail(node, fmt::format("there is neither a source nor an inline {}", root_name));
  return {&context.ssd, found, nullptr};
}

/// Returns the type with this element name in SSP 1.0 or FMI 3.0; nullopt if the name is unknown.
std::optional<Type> type_named(std::string_view name) {
  if (name == "Real") return Type::real;
  if (name == "Integer") return Type::integer;
  return fmi::type_of_word3(name);
}

/// Reads a whole number in the range of the type. Also accepts a number such as "7.0".
Json whole_number(const XmlFile& file, pugi::xml_node node, std::string_view text, Type type) {
  const auto limits = fmi::limits_of(type);
  const auto fits = [&](std::int64_t value) {
    return value >= limits.low && (value < 0 || static_cast<std::uint64_t>(value) <= limits.high);
  };
  const auto digits = text.substr(text.starts_with('+') ? 1 : 0);
  if (const auto value = parsed_number<std::uint64_t>(digits); value && *value <= limits.high) return *value;
  if (const auto value = parsed_number<std::int64_t>(digits); value && fits(*value)) return *value;
  const auto number = parse_number(text);
  if (const auto value = number ? exact_whole(*number) : std::nullopt; value && fits(*value)) return *value;
  file.fail(node, fmt::format("\"{}\" is not a whole number from {} to {}", text, limits.low, limits.high));
}

/// Returns the element with the value, such as <Real>; a null node if the parameter has no value.
pugi::xml_node type_of(pugi::xml_node parameter) {
  return parameter.find_child([](pugi::xml_node node) {
    const auto name = local_name(node);
    return node.type() == pugi::node_element && name != "Dimension" && name != "Annotations" && name != "MetaData";
  });
}

/// Reads a scalar or an array element. The name of `node` is the type.
Json read_value(const XmlFile& file, pugi::xml_node node, const std::string& text) {
  const auto type = type_named(local_name(node));
  if (!type || *type == Type::clock) {
    file.fail(node,
              "this type is unknown; use Real, Integer, Boolean, String, Enumeration, Binary or a type of FMI 3.0");
  }
  if (fmi::is_float(*type)) {
    const auto value = parse_number(text);
    if (!value) file.fail(node, fmt::format("\"{}\" is not a finite number", text));
    return *value;
  }
  // Accepts the number of an item, because some tools do not support names of items.
  if (*type == Type::enumeration) return parse_number(text) ? whole_number(file, node, text, Type::int64) : Json(text);
  if (fmi::is_whole(*type)) return whole_number(file, node, text, *type);
  if (*type == Type::boolean) {
    const auto value = parse_flag(text);
    if (!value) file.fail(node, fmt::format("the attribute value is \"{}\", but true or false is expected", text));
    return *value;
  }
  if (*type == Type::binary) {
    const auto bytes = bytes_of_hexadecimal(text);
    if (!bytes) file.fail(node, fmt::format("\"{}\" are not pairs of hexadecimal digits", text));
    return hexadecimal(*bytes);
  }
  return text;
}

/// Returns the text of each value: one for a scalar, and one for each element of an array in row-major order.
std::vector<std::string> texts_of(const XmlFile& file, pugi::xml_node node, bool is_array) {
  std::vector<std::string> texts;
  for (const auto value : children(node, "Value")) texts.push_back(file.required(value, "value"));
  if (!texts.empty()) return texts;
  const auto type = local_name(node);
  const bool is_text = type == "String" || type == "Enumeration" || type == "Binary";
  if (is_array && !is_text) return words_of(file.required(node, "value"));
  if (is_array && !node.attribute("value")) return {};
  return {file.required(node, "value")};
}

std::vector<std::uint64_t> sizes_of(const XmlFile& file, pugi::xml_node parameter) {
  std::vector<std::uint64_t> sizes;
  std::uint64_t product = 1;
  for (const auto dimension : children(parameter, "Dimension")) {
    const auto text = file.required(dimension, "size");
    sizes.push_back(whole_number(file, dimension, text, Type::uint32).get<std::uint64_t>());
    product *= sizes.back();
    if (product > modeldesc::kMostElements)
      file.fail(dimension, fmt::format("the array has more than {} elements", modeldesc::kMostElements));
  }
  return sizes;
}

/// Returns the values of a parameter. The first member of a pair is "" for a scalar, or the indices of an array
/// element, such as "[2,3]".
std::vector<std::pair<std::string, Json>> values_of(const XmlFile& file, pugi::xml_node parameter) {
  const auto node = type_of(parameter);
  if (!node) file.fail(parameter, "it has no value: an element such as Real, Integer, Boolean or String is expected");
  const auto sizes = sizes_of(file, parameter);
  const auto texts = texts_of(file, node, !sizes.empty());
  const auto count = std::accumulate(sizes.begin(), sizes.end(), std::uint64_t{1}, std::multiplies());
  if (texts.size() != count) file.fail(node, fmt::format("it has {} values, but {} are expected", texts.size(), count));
  std::vector<std::pair<std::string, Json>> values;
  for (std::uint64_t i = 0; i < count; ++i) {
    values.emplace_back(sizes.empty() ? std::string() : modeldesc::element_name({}, sizes, i),
                        read_value(file, node, texts[i]));
  }
  return values;
}

struct MappingEntry {
  std::string source;
  std::string target;
  Transformation transformation;
};

std::vector<MappingEntry> read_mapping(const Part& mapping) {
  std::vector<MappingEntry> entries;
  for (const auto entry : children(mapping.node, "MappingEntry")) {
    entries.push_back({mapping.file->required(entry, "source"), mapping.file->required(entry, "target"),
                       read_transformation(*mapping.file, entry)});
  }
  return entries;
}

std::vector<Parameter> read_values(const BindingContext& context, const Part& values, const std::string& prefix) {
  // An inline ParameterSet uses the definitions of the SSD that contains it (4.4.1).
  auto definitions = read_definitions(*values.file, values.node);
  if (!values.own) definitions.units.insert(context.definitions.units.begin(), context.definitions.units.end());
  std::vector<Parameter> result;
  for (const auto node : children(child(values.node, "Parameters"), "Parameter")) {
    Parameter parameter;
    parameter.name = prefix + values.file->required(node, "name");
    parameter.unit = read_unit(type_of(node), definitions);
    parameter.file = values.file->name();
    parameter.place = values.file->place(node);
    try {
      for (auto& [indices, value] : values_of(*values.file, node)) {
        result.push_back(parameter);
        result.back().name += indices;
        result.back().value = std::move(value);
      }
    } catch (const InputError& error) {
      parameter.problem = error.what();  // reported only if the value is used
      result.push_back(std::move(parameter));
    }
  }
  return result;
}

/// Applies a parameter mapping (chapter 7). For each entry whose source is in `parameters`, returns a copy of this
/// parameter with the name and transformation of the entry. Drops parameters to which no entry refers.
std::vector<Parameter> mapped(const std::vector<Parameter>& parameters, const std::vector<MappingEntry>& entries) {
  std::multimap<std::string_view, const MappingEntry*> by_source;
  for (const auto& entry : entries) by_source.emplace(entry.source, &entry);
  std::vector<Parameter> result;
  for (const auto& parameter : parameters) {
    const auto [first, last] = by_source.equal_range(parameter.name);
    for (auto found = first; found != last; ++found) {
      auto copy = parameter;
      copy.name = found->second->target;
      copy.transformation = found->second->transformation;
      result.push_back(std::move(copy));
    }
  }
  return result;
}

void require_type(const XmlFile& file, pugi::xml_node node, std::string_view readable) {
  const std::string type = node.attribute("type").as_string(std::string(readable).c_str());
  if (type != readable) file.fail(node, fmt::format("the type {} is not supported; use {}", type, readable));
}

std::vector<Parameter> read_binding(const BindingContext& context, pugi::xml_node binding) {
  require_type(context.ssd, binding, kParameterSet);
  const auto values = part(context, binding, "ParameterValues", "ParameterSet");
  auto parameters = read_values(context, values, binding.attribute("prefix").value());
  const auto mapping = child(binding, "ParameterMapping");
  if (!mapping) return parameters;
  require_type(context.ssd, mapping, kParameterMapping);
  return mapped(parameters, read_mapping(part(context, mapping, nullptr, "ParameterMapping")));
}

}  // namespace

std::vector<Parameter> read_parameter_bindings(const BindingContext& context, pugi::xml_node element) {
  std::vector<Parameter> result;
  // The schema permits one <ParameterBindings>, but some tools write several.
  for (const auto list : children(element, "ParameterBindings")) {
    for (const auto binding : children(list, "ParameterBinding")) {
      auto parameters = read_binding(context, binding);
      std::ranges::move(parameters, std::back_inserter(result));
    }
  }
  return result;
}

}  // namespace mebots::master::ssp
