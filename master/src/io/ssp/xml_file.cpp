// SPDX-License-Identifier: Apache-2.0
#include "xml_file.hpp"

#include "mebots/input_error.hpp"
#include "mebots/modeldesc/xml_text.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

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
  const std::string_view text = found.value();
  if (text == "true" || text == "1") return true;
  if (text == "false" || text == "0") return false;
  fail(node, fmt::format("the attribute {} is \"{}\", but true or false is expected", attribute, text));
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
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace mebots::master::ssp
