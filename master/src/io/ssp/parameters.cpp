// SPDX-License-Identifier: Apache-2.0
#include "values.hpp"

#include "files.hpp"
#include "mebots/input_error.hpp"
#include "mebots/modeldesc/archive_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <memory>

namespace mebots::master::ssp {
namespace {

constexpr std::string_view kParameterSet = "application/x-ssp-parameter-set";
constexpr std::string_view kParameterMapping = "application/x-ssp-parameter-mapping";

/// An inline XML element, or the root element of the file named by `source`. Owns this file while the element is read.
struct Part {
  const XmlFile* file;
  pugi::xml_node node;
  std::unique_ptr<XmlFile> own;
};

/// Reads a file inside a component's FMU.
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

std::int32_t whole_number(const XmlFile& file, pugi::xml_node node, const std::string& text) {
  using Limits = std::numeric_limits<std::int32_t>;
  const auto value = parse_number(text);
  // The range is checked first, because a number out of range, or NaN, must not be converted.
  if (!value || !(*value >= Limits::min() && *value <= Limits::max()) || *value != std::floor(*value)) {
    file.fail(node, fmt::format("\"{}\" is not a whole number of 32 bits", text));
  }
  return static_cast<std::int32_t>(*value);
}

/// Returns the element that holds the value, such as <Real>; null if there is none.
pugi::xml_node type_of(pugi::xml_node parameter) {
  return parameter.find_child([](pugi::xml_node node) {
    const auto name = local_name(node);
    return node.type() == pugi::node_element && name != "Dimension" && name != "Annotations" && name != "MetaData";
  });
}

Json value_of(const XmlFile& file, pugi::xml_node parameter) {
  if (const auto dimension = child(parameter, "Dimension")) {
    file.fail(dimension, "values of arrays cannot be used; FMI 2.0 has scalars only");
  }
  if (const auto node = type_of(parameter)) {
    const auto type = local_name(node);
    const auto text = [&] { return file.required(node, "value"); };
    if (type == "Real" || type == "Float64" || type == "Float32") {
      const auto value = parse_number(text());
      if (!value) file.fail(node, fmt::format("\"{}\" is not a finite number", text()));
      return *value;
    }
    if (type == "Integer" || type.starts_with("Int") || type.starts_with("UInt")) {
      return whole_number(file, node, text());
    }
    if (type == "Boolean") {
      text();
      return file.flag(node, "value", false);
    }
    if (type == "String" || type == "Enumeration") {
      // The text may be the number of an enumeration item, because some tools do not support item names.
      auto word = text();
      if (type == "Enumeration" && parse_number(word)) return whole_number(file, node, word);
      return word;
    }
    if (type == "Binary") file.fail(node, "binary parameters cannot be used; FMI 2.0 has none");
  }
  file.fail(parameter, "it has no value: one of Real, Integer, Boolean, String and Enumeration is expected");
}

/// An entry of a parameter mapping: the name before and after the mapping, and the transformation of the value.
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
  // An inline ParameterSet belongs to the SSD's file, whose definitions apply (4.4.1).
  auto definitions = read_definitions(*values.file, values.node);
  if (!values.own) definitions.units.insert(context.definitions.units.begin(), context.definitions.units.end());
  std::vector<Parameter> result;
  for (const auto node : children(child(values.node, "Parameters"), "Parameter")) {
    Parameter parameter;
    parameter.name = prefix + values.file->required(node, "name");
    try {
      parameter.value = value_of(*values.file, node);
    } catch (const InputError& error) {
      parameter.problem = error.what();  // reported only if the value is needed
    }
    parameter.unit = read_unit(type_of(node), definitions);
    parameter.file = values.file->name();
    parameter.place = values.file->place(node);
    result.push_back(std::move(parameter));
  }
  return result;
}

/// Applies a parameter mapping (chapter 7). Each entry that names a parameter yields one parameter with the entry's new
/// name. Other parameters are dropped.
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
  // The schema allows only one <ParameterBindings> per element, but some tools write several.
  for (const auto list : children(element, "ParameterBindings")) {
    for (const auto binding : children(list, "ParameterBinding")) {
      auto parameters = read_binding(context, binding);
      std::ranges::move(parameters, std::back_inserter(result));
    }
  }
  return result;
}

}  // namespace mebots::master::ssp
