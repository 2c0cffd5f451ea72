// SPDX-License-Identifier: Apache-2.0
#include "fmi3_description.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

namespace mebots::check {
namespace {

std::string default_variability(const Fmi3Declared& variable) {
  if (variable.causality == "parameter" || variable.causality == "structuralParameter" ||
      variable.causality == "calculatedParameter")
    return "fixed";
  return variable.is_float() ? "continuous" : "discrete";
}

std::string default_initial(const Fmi3Declared& variable) {
  if (variable.type == "Clock" || variable.causality == "independent" || variable.causality == "input") return "";
  const bool is_exact = variable.causality == "parameter" || variable.causality == "structuralParameter" ||
                        variable.variability == "constant";
  return is_exact ? "exact" : "calculated";
}

std::vector<std::string> starts_of(pugi::xml_node node, std::string_view type) {
  if (type != "String" && type != "Binary") return words_of(node.attribute("start").value());
  std::vector<std::string> starts;
  for (const auto start : node.children("Start")) starts.emplace_back(start.attribute("value").value());
  return starts;
}

}  // namespace

Fmi3Description::Fmi3Description(std::string text) : text_(std::move(text)) {
  modeldesc::parse_xml(document_, text_, "modelDescription.xml");
  for (const auto node : root().child("ModelVariables").children())
    if (node.type() == pugi::node_element) read(node);
  // Resolves sizes last, because structural parameters may be declared after their arrays.
  for (Fmi3Declared& variable : variables_) {
    for (const auto dimension : variable.node.children("Dimension")) {
      const Fmi3Declared* const size = find(dimension.attribute("valueReference").as_uint(UINT32_MAX));
      const auto fixed = dimension.attribute("start").as_ullong();
      variable.elements *=
          size == nullptr || size->starts.empty() ? fixed : std::strtoull(size->starts.front().c_str(), nullptr, 10);
    }
  }
}

void Fmi3Description::read(pugi::xml_node node) {
  Fmi3Declared variable;
  variable.node = node;
  variable.name = node.attribute("name").value();
  variable.reference = node.attribute("valueReference").as_uint();
  variable.type = node.name();
  variable.causality = node.attribute("causality").as_string("local");
  variable.variability = node.attribute("variability").as_string(default_variability(variable).c_str());
  variable.initial = node.attribute("initial").as_string(default_initial(variable).c_str());
  variable.starts = starts_of(node, variable.type);
  by_reference_.emplace(variable.reference, variables_.size());
  variables_.push_back(std::move(variable));
}

const Fmi3Declared* Fmi3Description::find(std::uint32_t reference) const {
  const auto found = by_reference_.find(reference);
  return found == by_reference_.end() ? nullptr : &variables_[found->second];
}

std::string Fmi3Description::line(pugi::xml_node node) const {
  return fmt::format("line {}", modeldesc::line_of(text_, node.offset_debug()));
}

std::string Fmi3Description::place(const Fmi3Declared& variable) const {
  return fmt::format("{}, {}", line(variable.node), variable.name);
}

std::vector<pugi::xml_node> Fmi3Description::interfaces() const {
  std::vector<pugi::xml_node> found;
  for (const char* const name : {"ModelExchange", "CoSimulation", "ScheduledExecution"})
    if (const auto node = root().child(name)) found.push_back(node);
  return found;
}

}  // namespace mebots::check
