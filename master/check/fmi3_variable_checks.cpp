// SPDX-License-Identifier: Apache-2.0
#include "fmi3_description.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <utility>

namespace mebots::check {
namespace {

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

/// True if the causality permits the variability (FMI 3.0.2, section 2.4.7.4).
bool go_together(const Fmi3Declared& variable) {
  const std::string_view variability = variable.variability;
  if (variable.causality == "independent") return variability == "continuous";
  if (is_one_of(variable.causality, {"parameter", "structuralParameter", "calculatedParameter"}))
    return is_one_of(variability, {"fixed", "tunable"});
  if (variable.causality == "input") return is_one_of(variability, {"discrete", "continuous"});
  if (variable.causality == "output") return is_one_of(variability, {"constant", "discrete", "continuous"});
  return true;
}

bool may_have_initial(const Fmi3Declared& variable, std::string_view initial) {
  if (variable.causality == "independent") return initial.empty();
  if (variable.causality == "input") return initial.empty() || initial == "exact";
  if (variable.variability == "constant" || is_one_of(variable.causality, {"parameter", "structuralParameter"}))
    return initial == "exact";
  if (variable.causality == "calculatedParameter" || is_one_of(variable.variability, {"fixed", "tunable"}))
    return is_one_of(initial, {"approx", "calculated"});
  return true;
}

void check_start(const Fmi3Description& description, const Fmi3Declared& variable, Findings findings) {
  if (variable.type == "Clock") return;
  const bool wanted = is_one_of(variable.initial, {"exact", "approx"}) || variable.causality == "input";
  const bool forbidden = variable.initial == "calculated" || variable.causality == "independent";
  if (wanted && variable.starts.empty() && variable.elements != 0)
    findings.error(fmt::format("{} has no start value", description.place(variable)),
                   "inputs, parameters and variables with initial = exact or approx need one");
  if (forbidden && !variable.starts.empty())
    findings.error(fmt::format("{} has a start value, which the FMU computes", description.place(variable)),
                   "remove it, or declare initial = \"exact\" or \"approx\"");
}

double number_of(std::string_view text) {
  return std::strtod(std::string(text).c_str(), nullptr);
}

void check_limits(const Fmi3Description& description, const Fmi3Declared& variable, pugi::xml_node type,
                  Findings findings) {
  const auto limit = [&](const char* name) {
    const auto own = variable.node.attribute(name);
    return own ? own : type.attribute(name);
  };
  const auto least = limit("min");
  const auto most = limit("max");
  if (least && most && number_of(least.value()) > number_of(most.value()))
    findings.error(fmt::format("{}: min {} is above max {}", description.place(variable), least.value(), most.value()),
                   "swap them");
  if (is_one_of(variable.type, {"String", "Binary", "Boolean", "Clock"})) return;
  for (const auto& start : variable.starts) {
    if (least && number_of(start) < number_of(least.value()))
      findings.error(fmt::format("{}: start {} is below min {}", description.place(variable), start, least.value()),
                     "change start or the limits");
    if (most && number_of(start) > number_of(most.value()))
      findings.error(fmt::format("{}: start {} is above max {}", description.place(variable), start, most.value()),
                     "change start or the limits");
  }
}

void check_items(const Fmi3Description& description, const Fmi3Declared& variable, pugi::xml_node type,
                 Findings findings) {
  for (const auto& start : variable.starts) {
    const auto has_value = [&](pugi::xml_node item) {
      return number_of(item.attribute("value").value()) == number_of(start);
    };
    const auto items = type.children("Item");
    if (std::none_of(items.begin(), items.end(), has_value))
      findings.error(fmt::format("{}: start {} is not an item of {}", description.place(variable), start,
                                 type.attribute("name").value()),
                     "use the value of one of its items");
  }
}

}  // namespace

void check_fmi3_names(const Fmi3Description& description, Findings findings) {
  std::set<std::string> names;
  std::set<std::uint32_t> references;
  const auto claim = [&](const std::string& name, pugi::xml_node node) {
    if (name.empty())
      findings.error(fmt::format("{}: a variable has no name", description.line(node)), "name it");
    else if (!names.insert(name).second)
      findings.error(fmt::format("{}: the name {} is already taken", description.line(node), name), "rename one");
  };
  for (const Fmi3Declared& variable : description.variables()) {
    claim(variable.name, variable.node);
    for (const auto alias : variable.node.children("Alias")) claim(alias.attribute("name").value(), alias);
    if (!references.insert(variable.reference).second)
      findings.error(fmt::format("{}: the value reference {} is also that of another variable",
                                 description.place(variable), variable.reference),
                     "give each variable its own; other names of one variable are <Alias> elements");
  }
}

void check_fmi3_kinds(const Fmi3Description& description, Findings findings) {
  std::size_t independent = 0;
  for (const Fmi3Declared& variable : description.variables()) {
    const auto place = description.place(variable);
    if (variable.causality == "independent") {
      ++independent;
      if (!variable.is_float())
        findings.error(fmt::format("{}: the independent variable is of type {}", place, variable.type),
                       "declare it as Float64 or Float32");
    }
    if (!go_together(variable))
      findings.error(
          fmt::format("{}: causality {} cannot have variability {}", place, variable.causality, variable.variability),
          "see the table of FMI 3.0, section 2.4.7.4");
    if (variable.variability == "continuous" && !variable.is_float())
      findings.error(fmt::format("{}: a variable of type {} cannot be continuous", place, variable.type),
                     "declare it as discrete");
    if (variable.type != "Clock" && !may_have_initial(variable, variable.initial))
      findings.error(fmt::format("{}: initial = \"{}\" is not compatible with causality {} and variability {}", place,
                                 variable.initial, variable.causality, variable.variability),
                     "see the table of FMI 3.0, section 2.4.7.5");
    check_start(description, variable, findings);
  }
  if (independent != 1)
    findings.error(fmt::format("there are {} independent variables", independent),
                   "declare one, usually a Float64 named time");
}

void check_fmi3_types(const Fmi3Description& description, Findings findings) {
  const auto defined = [&](const char* list, std::string_view name) {
    for (const auto node : description.root().child(list).children())
      if (name == node.attribute("name").value()) return node;
    return pugi::xml_node();
  };
  for (const Fmi3Declared& variable : description.variables()) {
    const std::string_view name = variable.node.attribute("declaredType").value();
    const auto type = name.empty() ? pugi::xml_node() : defined("TypeDefinitions", name);
    if (!name.empty() && !type)
      findings.error(fmt::format("{}: the type {} is not defined", description.place(variable), name),
                     "define it in <TypeDefinitions>");
    if (type && variable.type + "Type" != type.name())
      findings.error(fmt::format("{}: it is of type {}, but {} is a <{}>", description.place(variable), variable.type,
                                 name, type.name()),
                     "declare both with one type");
    const std::string_view unit = variable.node.attribute("unit").value();
    if (!unit.empty() && !defined("UnitDefinitions", unit))
      findings.error(fmt::format("{}: the unit {} is not defined", description.place(variable), unit),
                     "define it in <UnitDefinitions>");
    check_limits(description, variable, type, findings);
    if (variable.type == "Enumeration" && type) check_items(description, variable, type, findings);
  }
}

void check_fmi3_arrays(const Fmi3Description& description, Findings findings) {
  for (const Fmi3Declared& variable : description.variables()) {
    const auto place = description.place(variable);
    const auto dimensions = variable.node.children("Dimension");
    if (variable.causality == "structuralParameter" && dimensions.begin() != dimensions.end())
      findings.error(fmt::format("{}: a structural parameter cannot be an array", place), "remove <Dimension>");
    bool sound = true;
    for (const auto dimension : dimensions) {
      const auto fixed = dimension.attribute("start");
      const auto reference = dimension.attribute("valueReference");
      if (static_cast<bool>(fixed) == static_cast<bool>(reference)) {
        findings.error(fmt::format("{}: a dimension needs either start or valueReference", place),
                       "give it one of them");
        sound = false;
        continue;
      }
      if (!reference) continue;
      const Fmi3Declared* const size = description.find(reference.as_uint());
      const bool is_size = size != nullptr && size->type == "UInt64" &&
                           (size->causality == "structuralParameter" || size->variability == "constant");
      if (!is_size) {
        findings.error(
            fmt::format("{}: its dimension refers to {}, which is not a structural parameter or constant of type "
                        "UInt64",
                        place, size == nullptr ? reference.value() : size->name),
            "declare the size as UInt64 with causality structuralParameter");
        sound = false;
      } else if (size->starts.empty() || number_of(size->starts.front()) < 1) {
        findings.error(fmt::format("{}: its dimension is {}, whose start is 0", place, size->name),
                       "set start to 1 or more");
        sound = false;
      }
    }
    if (sound && variable.starts.size() > 1 && variable.starts.size() != variable.elements)
      findings.error(
          fmt::format("{} has {} start values for {} elements", place, variable.starts.size(), variable.elements),
          "give one per element");
  }
}

void check_fmi3_clocks(const Fmi3Description& description, Findings findings) {
  for (const Fmi3Declared& variable : description.variables()) {
    const auto place = description.place(variable);
    for (const auto& word : words_of(variable.node.attribute("clocks").value())) {
      const Fmi3Declared* const clock =
          description.find(static_cast<std::uint32_t>(std::strtoul(word.c_str(), nullptr, 10)));
      if (clock == nullptr || clock->type != "Clock")
        findings.error(
            fmt::format("{}: clocks has {}, which is not a clock", place, clock == nullptr ? word : clock->name),
            "list value references of variables of type Clock");
    }
    if (const auto previous = variable.node.attribute("previous")) {
      const Fmi3Declared* const before = description.find(previous.as_uint());
      if (before == nullptr || before->type != variable.type || before->elements != variable.elements)
        findings.error(fmt::format("{}: previous is {}, which is not a variable of the same type and size", place,
                                   previous.value()),
                       "refer to the variable whose previous value it has");
    }
    if (variable.type != "Clock") continue;
    const std::string_view kind = variable.node.attribute("intervalVariability").value();
    const bool has_interval = variable.node.attribute("intervalDecimal") || variable.node.attribute("intervalCounter");
    if (is_one_of(kind, {"constant", "fixed"}) && !has_interval)
      findings.error(fmt::format("{}: a clock with intervalVariability {} has no interval", place, kind),
                     "add intervalDecimal");
    if (!is_one_of(kind, {"constant", "fixed", "tunable"}) && has_interval)
      findings.error(fmt::format("{}: a clock with intervalVariability {} must not have an interval", place, kind),
                     "remove intervalDecimal and intervalCounter");
    if (variable.node.attribute("supportsFraction").as_bool() && !variable.node.attribute("resolution"))
      findings.error(fmt::format("{}: it supports fractions, but has no resolution", place), "add resolution");
    if (const auto interval = variable.node.attribute("intervalDecimal"); interval && !(interval.as_double() > 0))
      findings.error(fmt::format("{}: its interval is {} s", place, interval.value()), "set one above 0");
  }
}

}  // namespace mebots::check
