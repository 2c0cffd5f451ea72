// SPDX-License-Identifier: Apache-2.0
#include "schema_rules.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <map>
#include <string_view>
#include <utility>

namespace mebots::check {
namespace {

// The grammar of FMI 2.0.4, sections 2.2 and 4.3.1, derived from the text of the standard.
constexpr RuleRow kRows[] = {
    {"fmiModelDescription",
     "fmiVersion! modelName! guid! description author version copyright license generationTool "
     "generationDateAndTime:date variableNamingConvention:naming numberOfEventIndicators:count",
     "ModelExchange? CoSimulation? UnitDefinitions? TypeDefinitions? LogCategories? DefaultExperiment? "
     "VendorAnnotations? ModelVariables ModelStructure"},

    {"ModelExchange",
     "modelIdentifier! needsExecutionTool:flag completedIntegratorStepNotNeeded:flag "
     "canBeInstantiatedOnlyOncePerProcess:flag canNotUseMemoryManagementFunctions:flag canGetAndSetFMUstate:flag "
     "canSerializeFMUstate:flag providesDirectionalDerivative:flag",
     "SourceFiles?"},
    {"CoSimulation",
     "modelIdentifier! needsExecutionTool:flag canHandleVariableCommunicationStepSize:flag "
     "canInterpolateInputs:flag maxOutputDerivativeOrder:count canRunAsynchronuously:flag "
     "canBeInstantiatedOnlyOncePerProcess:flag canNotUseMemoryManagementFunctions:flag canGetAndSetFMUstate:flag "
     "canSerializeFMUstate:flag providesDirectionalDerivative:flag",
     "SourceFiles?"},
    {"SourceFiles", "", "File+"},
    {"File", "name!", ""},

    {"UnitDefinitions", "", "Unit+"},
    {"Unit", "name!", "BaseUnit? DisplayUnit*"},
    {"BaseUnit", "kg:whole m:whole s:whole A:whole K:whole mol:whole cd:whole rad:whole factor:number offset:number",
     ""},
    {"DisplayUnit", "name! factor:number offset:number", ""},

    {"TypeDefinitions", "", "SimpleType+"},
    {"SimpleType", "name! description",
     "| Real=RealType? Integer=IntegerType? Boolean=BooleanType? String=StringType? Enumeration=EnumerationType?"},
    {"RealType", "quantity unit displayUnit relativeQuantity:flag min:number max:number nominal:number unbounded:flag",
     ""},
    {"IntegerType", "quantity min:whole max:whole", ""},
    {"BooleanType", "", ""},
    {"StringType", "", ""},
    {"EnumerationType", "quantity", "Item+"},
    {"Item", "name! value:whole! description", ""},

    {"LogCategories", "", "Category+"},
    {"Category", "name! description", ""},
    {"DefaultExperiment", "startTime:number stopTime:number tolerance:number stepSize:number", ""},
    {"VendorAnnotations", "", "Tool+"},
    {"Annotations", "", "Tool+"},
    {"Tool", "name!", "..."},

    {"ModelVariables", "", "ScalarVariable+"},
    {"ScalarVariable",
     "name! valueReference:count! description causality:causality variability:variability initial:initial "
     "canHandleMultipleSetPerTimeInstant:flag",
     "| Real? Integer? Boolean? String? Enumeration? Annotations?"},
    {"Real",
     "declaredType quantity unit displayUnit relativeQuantity:flag min:number max:number nominal:number "
     "unbounded:flag start:number derivative:count reinit:flag",
     ""},
    {"Integer", "declaredType quantity min:whole max:whole start:whole", ""},
    {"Boolean", "declaredType start:flag", ""},
    {"String", "declaredType start", ""},
    {"Enumeration", "declaredType! quantity min:whole max:whole start:whole", ""},

    {"ModelStructure", "", "Outputs=Unknowns? Derivatives=Unknowns? InitialUnknowns=Unknowns?"},
    {"Unknowns", "", "Unknown+"},
    {"Unknown", "index:count! dependencies dependenciesKind:dependencies", ""},
};

/// Removes `mark` from the end of the text. Returns false if the text does not end with it.
bool take_mark(std::string_view& text, char mark) {
  if (!text.ends_with(mark)) return false;
  text.remove_suffix(1);
  return true;
}

/// Splits `name<separator>rest`. Without the separator, returns the whole text twice.
std::pair<std::string_view, std::string_view> divided(std::string_view text, char separator) {
  const auto at = text.find(separator);
  if (at == std::string_view::npos) return {text, text};
  return {text.substr(0, at), text.substr(at + 1)};
}

template <typename Action>
void for_each_word(std::string_view text, Action action) {
  while (!text.empty()) {
    const auto [word, rest] = divided(text, ' ');
    action(word);
    text = word.size() == text.size() ? std::string_view() : rest;
  }
}

using Rules = std::map<std::string_view, ElementRule>;

AttributeRule attribute_rule(std::string_view word) {
  const bool required = take_mark(word, '!');
  const auto [name, form] = divided(word, ':');
  return {std::string(name), &find_form(name.size() == word.size() ? "text" : form), required};
}

ChildRule child_rule(std::string_view word, const Rules& rules) {
  const bool none_or_one = take_mark(word, '?');
  const bool one_or_more = take_mark(word, '+');
  const bool any = take_mark(word, '*');
  const auto [name, rule] = divided(word, '=');
  const auto found = rules.find(rule);
  if (found == rules.end()) throw Error(ErrorCode::unknown_name, fmt::format("the schema has no rule '{}'", rule));
  return {std::string(name), &found->second, none_or_one || any ? 0U : 1U, one_or_more || any ? SIZE_MAX : 1U};
}

Rules read_rows(std::span<const RuleRow> rows) {
  Rules rules;
  // Creates all rules before it links them, because children may refer to later rows.
  for (const RuleRow& row : rows) rules[row.rule];
  for (const RuleRow& row : rows) {
    ElementRule& rule = rules[row.rule];
    for_each_word(row.attributes, [&](std::string_view word) { rule.attributes.push_back(attribute_rule(word)); });
    for_each_word(row.children, [&](std::string_view word) {
      if (word == "|") {
        rule.alternatives = true;
      } else if (word == "&") {
        rule.unordered = true;
      } else if (word == "...") {
        rule.anything = true;
      } else {
        rule.children.push_back(child_rule(word, rules));
      }
    });
  }
  return rules;
}

const Rules& fmi1_rules() {
  static const Rules kRules = read_rows(fmi1_rule_rows());
  return kRules;
}

const Rules& fmi3_rules() {
  static const Rules kRules = read_rows(fmi3_rule_rows());
  return kRules;
}

}  // namespace

Grammar grammar_of(std::string_view fmi_version) {
  static const Rules kRules = read_rows(kRows);
  if (fmi_version == "1.0") return {"1.0", &fmi1_rules().at("fmiModelDescription"), false};
  if (fmi_version.starts_with("3.")) return {"3.0", &fmi3_rules().at("fmiModelDescription"), true};
  return {"2.0", &kRules.at("fmiModelDescription"), false};
}

Grammar grammar_of_terminals() {
  return {"3.0", &fmi3_rules().at("fmiTerminalsAndIcons"), true};
}

}  // namespace mebots::check
