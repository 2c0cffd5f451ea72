// SPDX-License-Identifier: Apache-2.0
#include "fmi3_description.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <map>
#include <set>

namespace mebots::check {
namespace {

bool is_identifier(std::string_view text) {
  const auto is_word = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; };
  return !text.empty() && std::isdigit(static_cast<unsigned char>(text.front())) == 0 &&
         std::ranges::all_of(text, is_word);
}

void check_interface(const Fmi3Description& description, pugi::xml_node node, Findings findings) {
  const std::string_view identifier = node.attribute("modelIdentifier").value();
  if (!is_identifier(identifier))
    findings.error(fmt::format("{}: modelIdentifier \"{}\" is not a C identifier", description.line(node), identifier),
                   "use letters, digits and _: it names the library");
  if (node.attribute("canSerializeFMUState").as_bool() && !node.attribute("canGetAndSetFMUState").as_bool())
    findings.error(fmt::format("{}: canSerializeFMUState without canGetAndSetFMUState", description.line(node)),
                   "a state must be read before it can be serialised");
  if (node.attribute("needsExecutionTool").as_bool())
    findings.at(Level::pedantic)
        .warning(fmt::format("{}: <{}> has needsExecutionTool: it runs only where that tool is installed",
                             description.line(node), node.name()),
                 "export a library that runs alone, if the tool can");
  if (std::string_view(node.name()) != "CoSimulation") return;
  const auto fixed = node.attribute("fixedInternalStepSize");
  if (fixed && !(fixed.as_double() > 0))
    findings.error(fmt::format("{}: fixedInternalStepSize is {}", description.line(node), fixed.value()),
                   "set a step above 0");
  if (node.attribute("canReturnEarlyAfterIntermediateUpdate").as_bool() &&
      !node.attribute("providesIntermediateUpdate").as_bool())
    findings.error(fmt::format("{}: canReturnEarlyAfterIntermediateUpdate without providesIntermediateUpdate",
                               description.line(node)),
                   "offer both, or neither");
}

/// True if ModelStructure must list the variable as InitialUnknown (FMI 3.0.2, section 2.4.8).
bool is_initial_unknown(const Fmi3Declared& variable, const std::set<std::uint32_t>& derivatives,
                        const std::set<std::uint32_t>& states) {
  if (variable.type == "Clock" || variable.node.attribute("clocks")) return false;
  const bool is_open = variable.initial == "approx" || variable.initial == "calculated";
  return is_open && (variable.causality == "output" || variable.causality == "calculatedParameter" ||
                     derivatives.contains(variable.reference) || states.contains(variable.reference));
}

class StructureCheck {
 public:
  StructureCheck(const Fmi3Description& description, Findings findings)
      : description_(description), findings_(findings) {}

  void run() {
    for (const auto entry : description_.root().child("ModelStructure").children())
      if (entry.type() == pugi::node_element) read(entry);
    std::set<std::uint32_t> states;
    for (const auto reference : listed_["ContinuousStateDerivative"]) {
      const Fmi3Declared* const derivative = description_.find(reference);
      if (derivative == nullptr) continue;
      const auto state = derivative->node.attribute("derivative");
      if (!state)
        findings_.error(fmt::format("{}: ModelStructure lists it as a derivative, but it has no attribute derivative",
                                    description_.place(*derivative)),
                        "declare derivative = value reference of the state");
      else if (description_.find(state.as_uint()) == nullptr)
        findings_.error(fmt::format("{}: derivative is {}, which is not a variable", description_.place(*derivative),
                                    state.value()),
                        "refer to the state");
      states.insert(state.as_uint());
    }
    for (const Fmi3Declared& variable : description_.variables()) {
      const bool is_output = variable.causality == "output";
      compare(variable, "Output", is_output);
      const bool is_open = is_initial_unknown(variable, listed_["ContinuousStateDerivative"], states);
      compare(variable, "InitialUnknown", is_open);
    }
  }

 private:
  void read(pugi::xml_node entry) {
    const std::string list = entry.name();
    const auto reference = entry.attribute("valueReference").as_uint();
    const auto place = fmt::format("{}, <{}>", description_.line(entry), list);
    if (description_.find(reference) == nullptr)
      findings_.error(fmt::format("{}: there is no variable with the value reference {}", place, reference),
                      "refer to a variable");
    if (!listed_[list].insert(reference).second)
      findings_.error(fmt::format("{}: the value reference {} is listed twice", place, reference), "list it once");
    const auto dependencies = words_of(entry.attribute("dependencies").value());
    for (const auto& word : dependencies) {
      if (description_.find(static_cast<std::uint32_t>(std::strtoul(word.c_str(), nullptr, 10))) == nullptr)
        findings_.error(fmt::format("{}: it depends on {}, which is not a variable", place, word),
                        "refer to a variable");
    }
    const auto kinds = words_of(entry.attribute("dependenciesKind").value());
    if (entry.attribute("dependenciesKind") && kinds.size() != dependencies.size())
      findings_.error(fmt::format("{}: {} kinds for {} dependencies", place, kinds.size(), dependencies.size()),
                      "list one per dependency");
  }

  void compare(const Fmi3Declared& variable, const std::string& list, bool wanted) {
    const bool is_there = listed_[list].contains(variable.reference);
    if (wanted && !is_there)
      findings_.error(fmt::format("{}: it is missing as <{}> of ModelStructure", description_.place(variable), list),
                      "list it");
    if (is_there && !wanted && list == "Output")
      findings_.error(fmt::format("{}: ModelStructure lists it as <{}>, but its causality is {}",
                                  description_.place(variable), list, variable.causality),
                      "remove the entry");
  }

  const Fmi3Description& description_;
  Findings findings_;
  std::map<std::string, std::set<std::uint32_t>> listed_;
};

}  // namespace

void check_fmi3_head(const Fmi3Description& description, Findings findings) {
  const auto interfaces = description.interfaces();
  if (interfaces.empty())
    findings.error("there is no <ModelExchange>, <CoSimulation> or <ScheduledExecution>",
                   "declare what the FMU offers");
  for (const auto node : interfaces) check_interface(description, node, findings);
  if (*description.root().attribute("instantiationToken").value() == '\0')
    findings.error("the instantiationToken is empty", "set one that changes whenever the interface changes");
  std::set<std::string> categories;
  for (const auto node : description.root().child("LogCategories").children("Category"))
    if (!categories.insert(node.attribute("name").value()).second)
      findings.error(
          fmt::format("{}: the log category {} occurs twice", description.line(node), node.attribute("name").value()),
          "list it once");
  const auto experiment = description.root().child("DefaultExperiment");
  const auto start = experiment.attribute("startTime").as_double(0);
  if (const auto stop = experiment.attribute("stopTime"); stop && stop.as_double() < start)
    findings.error(
        fmt::format("{}: stopTime {} is before startTime {}", description.line(experiment), stop.value(), start),
        "set stopTime to a later time");
  for (const char* const name : {"stepSize", "tolerance"})
    if (const auto value = experiment.attribute(name); value && !(value.as_double() > 0))
      findings.error(fmt::format("{}: {} is {}", description.line(experiment), name, value.value()),
                     "set a number above 0");
}

void check_fmi3_structure(const Fmi3Description& description, Findings findings) {
  StructureCheck(description, findings).run();
}

}  // namespace mebots::check
