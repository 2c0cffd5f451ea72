// SPDX-License-Identifier: Apache-2.0
#include "parameters.hpp"

#include "mebots/input_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>

namespace mebots::master::ssp {
namespace {

using Json = nlohmann::ordered_json;

std::string percent_decoded(const std::string& uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned value = 0;
    if (uri[i] == '%' && i + 2 < uri.size()) {
      const auto* digits = uri.data() + i + 1;
      if (std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2) {
        text += static_cast<char>(value);
        i += 2;
        continue;
      }
    }
    text += uri[i];
  }
  return text;
}

/// An inline element, or the root of the file that `source` names. Keeps the file while it is read.
struct Part {
  const XmlFile* file;
  pugi::xml_node node;
  std::unique_ptr<XmlFile> own;
};

Part part(const Source& source, const XmlFile& file, pugi::xml_node node, const char* inline_holder,
          std::string_view root_name) {
  if (const auto uri = node.attribute("source")) {
    const auto base = std::string_view(node.attribute("sourceBase").as_string("SSD"));
    if (base != "SSD")
      file.fail(node, fmt::format("sourceBase=\"{}\" is not supported; put the file into the SSP", base));
    const auto path = resolve_uri(source, file, node, uri.value());
    auto own = std::make_unique<XmlFile>(source.files.read(path), fmt::format("{}: {}", source.archive, path.string()));
    const auto root = own->root();
    if (local_name(root) != root_name) own->fail(root, fmt::format("the root element must be {}", root_name));
    const auto* raw = own.get();
    return {raw, root, std::move(own)};
  }
  const auto holder = inline_holder == nullptr ? node : child(node, inline_holder);
  const auto found = child(holder, root_name);
  if (!found) file.fail(node, fmt::format("neither a source nor an inline {} is there", root_name));
  return {&file, found, nullptr};
}

std::int32_t whole_number(const XmlFile& file, pugi::xml_node node, const std::string& text) {
  using Limits = std::numeric_limits<std::int32_t>;
  const auto value = parse_number(text);
  // Comparisons first: a number that does not fit, or NaN, must not be converted.
  if (!value || !(*value >= Limits::min() && *value <= Limits::max()) || *value != std::floor(*value)) {
    file.fail(node, fmt::format("\"{}\" is not a whole number of 32 bits", text));
  }
  return static_cast<std::int32_t>(*value);
}

Json value_of(const XmlFile& file, pugi::xml_node parameter) {
  for (const auto node : parameter.children()) {
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
      // Tools that know no items write an enumeration's number.
      auto word = text();
      if (type == "Enumeration" && parse_number(word)) return whole_number(file, node, word);
      return word;
    }
    if (type == "Binary") file.fail(node, "binary parameters are nothing that FMI 2.0 knows");
  }
  file.fail(parameter, "it has no value: one of Real, Integer, Boolean, String and Enumeration is expected");
}

void transform(const XmlFile& file, pugi::xml_node entry, Json& value) {
  for (const auto* unsupported :
       {"BooleanMappingTransformation", "IntegerMappingTransformation", "EnumerationMappingTransformation"}) {
    const auto node = child(entry, unsupported);
    if (!node) continue;
    const auto shown = value.is_string() ? value.get<std::string>() : value.dump();
    for (const auto map : children(node, "MapEntry")) {
      auto source = file.required(map, "source");
      if (value.is_boolean()) source = source == "1" || source == "true" ? "true" : "false";
      if (source != shown) continue;
      const auto target = file.required(map, "target");
      if (value.is_boolean()) {
        value = target == "true" || target == "1";
      } else if (value.is_string()) {
        value = target;
      } else {
        value = whole_number(file, map, target);
      }
      return;
    }
    file.fail(node, fmt::format("no MapEntry is for the value {}", shown));
  }
  const auto linear = child(entry, "LinearTransformation");
  if (!linear) return;
  if (!value.is_number()) file.fail(linear, "only numbers can be transformed linearly");
  const double factor = file.number(linear, "factor", 1);
  const double offset = file.number(linear, "offset", 0);
  if (factor == 1 && offset == 0) return;
  value = factor * value.get<double>() + offset;
  if (!std::isfinite(value.get<double>())) file.fail(linear, "the value leaves the range of numbers");
}

std::vector<Parameter> read_values(const Part& values, const std::string& prefix) {
  std::vector<Parameter> result;
  for (const auto node : children(child(values.node, "Parameters"), "Parameter")) {
    result.push_back(
        {prefix + values.file->required(node, "name"), value_of(*values.file, node), values.file->place(node)});
  }
  return result;
}

/// SSP 1.0: with a mapping, the parameters that it names take their new names and values, one for each entry;
/// the others are left as they are.
std::vector<Parameter> mapped(const std::vector<Parameter>& parameters, const Part& mapping) {
  std::vector<Parameter> result;
  const auto entries = children(mapping.node, "MappingEntry");
  for (const auto& parameter : parameters) {
    bool found = false;
    for (const auto entry : entries) {
      if (mapping.file->required(entry, "source") != parameter.name) continue;
      auto copy = parameter;
      copy.name = mapping.file->required(entry, "target");
      transform(*mapping.file, entry, copy.value);
      result.push_back(std::move(copy));
      found = true;
    }
    if (!found) result.push_back(parameter);
  }
  return result;
}

}  // namespace

std::filesystem::path resolve_uri(const Source& source, const XmlFile& file, pugi::xml_node node,
                                  const std::string& uri) {
  const std::filesystem::path relative = percent_decoded(uri);
  if (uri.find("://") != std::string::npos || relative.is_absolute()) {
    file.fail(node, fmt::format("the source \"{}\" is absolute; only files inside the SSP can be used", uri));
  }
  auto normal = relative.lexically_normal();
  if (normal.empty() || *normal.begin() == "..") {
    file.fail(node, fmt::format("the source \"{}\" is not inside the SSP", uri));
  }
  if (!source.files.holds(normal)) file.fail(node, fmt::format("the SSP holds no file \"{}\"", uri));
  return normal;
}

std::vector<Parameter> read_parameter_bindings(const Source& source, const XmlFile& file, pugi::xml_node element) {
  std::vector<Parameter> result;
  for (const auto binding : children(child(element, "ParameterBindings"), "ParameterBinding")) {
    const auto type = std::string_view(binding.attribute("type").as_string("application/x-ssp-parameter-set"));
    if (type != "application/x-ssp-parameter-set") {
      file.fail(binding, fmt::format("parameters of type {} cannot be read; only SSV can", type));
    }
    const auto values = part(source, file, binding, "ParameterValues", "ParameterSet");
    auto parameters = read_values(values, binding.attribute("prefix").value());
    if (const auto node = child(binding, "ParameterMapping")) {
      parameters = mapped(parameters, part(source, file, node, nullptr, "ParameterMapping"));
    }
    result.insert(result.end(), parameters.begin(), parameters.end());
  }
  return result;
}

}  // namespace mebots::master::ssp
