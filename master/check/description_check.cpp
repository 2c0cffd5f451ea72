// SPDX-License-Identifier: Apache-2.0
#include "checks.hpp"

#include "mebots/file_kind.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace mebots::check {
namespace {

using modeldesc::Causality;
using modeldesc::Initial;
using modeldesc::Type;
using modeldesc::Unknown;
using modeldesc::Variability;
using modeldesc::Variable;

bool is_c_identifier(std::string_view text) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  return !text.empty() && letter(text.front()) &&
         std::ranges::all_of(text, [&](char c) { return letter(c) || (c >= '0' && c <= '9'); });
}

bool has_start(const Variable& variable) {
  return !std::holds_alternative<std::monostate>(variable.start);
}

std::optional<double> number_of(const Variable& variable) {
  if (const auto* real = std::get_if<double>(&variable.start)) return *real;
  if (const auto* integer = std::get_if<std::int64_t>(&variable.start)) return *integer;
  return std::nullopt;
}

std::string quoted(const Variable& variable) {
  return fmt::format("\"{}\"", variable.name);
}

/// Returns the variabilities permitted for a causality (FMI 2.0.4, section 2.2.7).
std::vector<Variability> legal_variabilities(Causality causality) {
  using V = Variability;
  switch (causality) {
    case Causality::parameter:
    case Causality::calculated_parameter:
      return {V::fixed, V::tunable};
    case Causality::input:
      return {V::discrete, V::continuous};
    case Causality::output:
      return {V::constant, V::discrete, V::continuous};
    case Causality::local:
      return {V::constant, V::fixed, V::tunable, V::discrete, V::continuous};
    case Causality::independent:
      return {V::continuous};
    case Causality::structural_parameter:
    case Causality::dependent:
      break;  // only in FMI 3.0
  }
  return {};
}

/// Returns the permitted values of `initial`. Empty if the attribute is not permitted.
std::vector<Initial> legal_initials(Causality causality, Variability variability) {
  using I = Initial;
  if (causality == Causality::input || causality == Causality::independent) return {};
  if (causality == Causality::parameter || variability == Variability::constant) return {I::exact};
  if (causality == Causality::calculated_parameter || variability == Variability::fixed ||
      variability == Variability::tunable)
    return {I::calculated, I::approx};
  return {I::calculated, I::exact, I::approx};
}

template <typename List>
std::string words(const List& list) {
  std::string text;
  for (const auto& item : list) text += (text.empty() ? "" : ", ") + std::string(to_string(item));
  return text;
}

void check_combination(const Variable& variable, Findings& findings) {
  const auto variabilities = legal_variabilities(variable.causality);
  if (std::ranges::find(variabilities, variable.variability) == variabilities.end()) {
    findings.error(fmt::format("{}: causality {} cannot have variability {}", quoted(variable),
                               to_string(variable.causality), to_string(variable.variability)),
                   fmt::format("use variability {}", words(variabilities)));
    return;
  }
  const auto initials = legal_initials(variable.causality, variable.variability);
  if (variable.initial && initials.empty())
    findings.error(fmt::format("{}: an {} has no initial", quoted(variable), to_string(variable.causality)),
                   "remove the attribute initial");
  if (variable.initial && !initials.empty() && std::ranges::find(initials, *variable.initial) == initials.end())
    findings.error(
        fmt::format("{}: initial {} is not compatible with causality {} and variability {}", quoted(variable),
                    to_string(*variable.initial), to_string(variable.causality), to_string(variable.variability)),
        fmt::format("use initial {}", words(initials)));
}

void check_start(const ModelDescription& model, const Variable& variable, Findings& findings) {
  const bool needed =
      variable.causality == Causality::input || (variable.initial && *variable.initial != Initial::calculated);
  if (needed && !has_start(variable))
    findings.error(fmt::format("{} has no start value", quoted(variable)), variable.causality == Causality::input
                                                                               ? "every input needs one"
                                                                               : "initial exact and approx need one");
  const bool forbidden =
      variable.causality == Causality::independent || (variable.initial && *variable.initial == Initial::calculated);
  if (forbidden && has_start(variable))
    findings.error(fmt::format("{} has a start value, but {} forbids a start value", quoted(variable),
                               variable.causality == Causality::independent ? "its causality (independent)"
                                                                            : "its attribute initial (calculated)"),
                   "remove start, or use initial exact or approx");
  const auto start = number_of(variable);
  if (start && !std::isfinite(*start))
    findings.error(fmt::format("{} starts at {}", quoted(variable), *start), "set a finite start value");
  if (start && variable.min && *start < *variable.min)
    findings.error(fmt::format("{} starts at {}, below its min {}", quoted(variable), *start, *variable.min),
                   "change start or min");
  if (start && variable.max && *start > *variable.max)
    findings.error(fmt::format("{} starts at {}, above its max {}", quoted(variable), *start, *variable.max),
                   "change start or max");
  if (variable.type != Type::enumeration) return;
  const auto* type = model.type_definition(variable.declared_type);
  if (type == nullptr) {
    findings.error(fmt::format("the enumeration {} has no declared type", quoted(variable)),
                   "add declaredType and define its items in TypeDefinitions");
  } else if (start && std::ranges::none_of(type->items, [&](const auto& item) { return item.value == *start; })) {
    findings.error(fmt::format("{} starts at {}, which is not an item of {}", quoted(variable), *start, type->name),
                   "use the value of one of its items");
  }
}

template <typename Limits>
void check_limits(const std::string& what, const Limits& limits, Findings& findings) {
  if (limits.min && limits.max && *limits.min > *limits.max)
    findings.error(fmt::format("{}: min {} is above max {}", what, *limits.min, *limits.max), "swap them");
  if (limits.nominal && !(*limits.nominal > 0))
    findings.error(fmt::format("{}: nominal is {}, but must be above 0", what, *limits.nominal),
                   "set it to the usual magnitude");
}

template <typename Source>
void check_unit(const ModelDescription& model, const std::string& what, const Source& source, Findings& findings) {
  const auto* unit = model.unit(source.unit);
  if (!source.unit.empty() && unit == nullptr)
    findings.error(fmt::format("{}: the unit \"{}\" is not defined", what, source.unit),
                   "add it to UnitDefinitions with its BaseUnit");
  if (source.display_unit.empty()) return;
  if (source.unit.empty())
    findings.error(fmt::format("{} has a display unit \"{}\" without a unit", what, source.display_unit),
                   "add the unit");
  else if (unit != nullptr &&
           std::ranges::none_of(unit->display_units, [&](const auto& d) { return d.name == source.display_unit; }))
    findings.error(fmt::format("{}: the display unit \"{}\" is not defined under unit \"{}\"", what,
                               source.display_unit, source.unit),
                   "add a DisplayUnit to the unit");
}

void check_experiment(const modeldesc::DefaultExperiment& experiment, Findings& findings) {
  const double start = experiment.start_time_s.value_or(0);
  if (experiment.stop_time_s && !(*experiment.stop_time_s > start))
    findings.error(
        fmt::format("DefaultExperiment: stopTime {} is not after startTime {}", *experiment.stop_time_s, start),
        "change one of them");
  const auto positive = [&](const std::optional<double>& value, const char* name) {
    if (value && !(*value > 0))
      findings.error(fmt::format("DefaultExperiment: {} is {}, but must be above 0", name, *value),
                     "change or remove it");
  };
  positive(experiment.step_size_s, "stepSize");
  positive(experiment.tolerance, "tolerance");
}

/// Parses structured names (FMI 2.0.4, section 2.2.9). Each function implements a rule of the grammar.
class NameReader {
 public:
  explicit NameReader(std::string_view text) : text_(text) {}
  bool whole() { return (derivative() || identifier()) && at_ == text_.size(); }

 private:
  bool derivative() {
    const auto before = at_;
    if (word("der(") && identifier()) {
      if (take(',') && !number()) return back(before);
      if (take(')')) return true;
    }
    return back(before);
  }
  bool identifier() {
    if (!name()) return false;
    if (!indices()) return false;
    while (take('.'))
      if (!name() || !indices()) return false;
    return true;
  }
  bool name() { return take('\'') ? quoted() : plain(); }
  bool plain() {
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
    if (at_ == text_.size() || !letter(text_[at_])) return false;
    while (at_ < text_.size() && (letter(text_[at_]) || digit(text_[at_]))) ++at_;
    return true;
  }
  bool quoted() {
    const auto start = at_;
    while (at_ < text_.size() && text_[at_] != '\'') at_ += text_[at_] == '\\' ? 2 : 1;
    return at_ > start && at_ < text_.size() && take('\'');
  }
  bool indices() {
    if (!take('[')) return true;
    do {
      if (!number()) return false;
    } while (take(','));
    return take(']');
  }
  bool number() {
    const auto start = at_;
    while (at_ < text_.size() && digit(text_[at_])) ++at_;
    return at_ > start;
  }
  static bool digit(char c) { return c >= '0' && c <= '9'; }
  bool take(char c) {
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  bool word(std::string_view wanted) {
    if (!text_.substr(at_).starts_with(wanted)) return false;
    at_ += wanted.size();
    return true;
  }
  bool back(std::size_t before) {
    at_ = before;
    return false;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

void compare_unknowns(const ModelDescription& model, const char* list, const std::vector<Unknown>& found,
                      const std::set<std::size_t>& wanted, const char* rule, Findings& findings) {
  std::set<std::size_t> seen;
  for (const auto& unknown : found) {
    const auto& variable = model.variables[unknown.variable];
    if (!seen.insert(unknown.variable).second)
      findings.error(fmt::format("{} lists {} twice", list, quoted(variable)), "keep one entry");
    if (!wanted.contains(unknown.variable))
      findings.error(fmt::format("{} lists {}, which does not belong there", list, quoted(variable)),
                     fmt::format("it must list {}", rule));
  }
  for (const auto index : wanted)
    if (!seen.contains(index))
      findings.error(fmt::format("{} lacks {}", list, quoted(model.variables[index])),
                     fmt::format("it must list {}", rule));
  if (!std::ranges::is_sorted(found, {}, &Unknown::variable))
    findings.error(fmt::format("{} is not in the order of ModelVariables", list), "sort it by index");
}

}  // namespace

bool is_structured_name(std::string_view name) {
  return NameReader(name).whole();
}

void check_head(const ModelDescription& model, const std::filesystem::path& folder, Findings findings) {
  if (model.model_name.empty()) findings.error("modelName is empty", "name the model");
  if (model.guid.empty())
    findings.error("guid is empty", "set it to a text that changes with the description, such as a UUID");
  if (!model.co_simulation) return;
  const auto& flags = *model.co_simulation;
  if (!is_c_identifier(flags.model_identifier))
    findings.error(fmt::format("modelIdentifier \"{}\" is not a C identifier", flags.model_identifier),
                   "use letters, digits and underscores, not starting with a digit");
  if (flags.can_serialize_fmu_state && !flags.can_get_and_set_fmu_state)
    findings.error("canSerializeFMUstate is true, but canGetAndSetFMUstate is not",
                   "a state must be read before it can be serialised");
  for (const auto& file : flags.source_files)
    if (!is_there(folder / "sources" / file))
      findings.error(fmt::format("SourceFiles names \"{}\", which the folder sources does not contain", file),
                     "pack it, or remove the entry");
  std::set<std::string> categories;
  for (const auto& category : model.log_categories) {
    if (category.name.empty()) findings.error("a log category has no name", "name it");
    if (!categories.insert(category.name).second)
      findings.error(fmt::format("the log category \"{}\" occurs twice", category.name), "keep one");
  }
  check_experiment(model.default_experiment, findings);
}

void check_units_and_types(const ModelDescription& model, Findings findings) {
  for (const auto& unit : model.units) {
    if (unit.has_base && (unit.factor == 0 || !std::isfinite(unit.factor) || !std::isfinite(unit.offset)))
      findings.error(fmt::format("the unit \"{}\" has factor {} and offset {}", unit.name, unit.factor, unit.offset),
                     "a factor must be finite and not 0");
    std::set<std::string> names;
    for (const auto& display : unit.display_units) {
      if (!names.insert(display.name).second)
        findings.error(fmt::format("the unit \"{}\" has two display units \"{}\"", unit.name, display.name),
                       "keep one");
      if (display.factor == 0)
        findings.error(fmt::format("the display unit \"{}\" has factor 0", display.name), "set the factor");
    }
  }
  for (const auto& type : model.types) {
    const auto what = fmt::format("type \"{}\"", type.name);
    check_unit(model, what, type, findings);
    check_limits(what, type, findings);
    if (model.find(type.name) != nullptr)
      findings.error(fmt::format("{} has the name of a variable", what), "rename the type");
    std::set<std::string> names;
    std::set<std::int64_t> values;
    for (const auto& item : type.items)
      if (!names.insert(item.name).second || !values.insert(item.value).second)
        findings.error(fmt::format("{}: the item \"{}\" = {} occurs twice", what, item.name, item.value),
                       "names and values must be unique");
  }
  for (const auto& variable : model.variables) {
    check_unit(model, quoted(variable), variable, findings);
    check_limits(quoted(variable), variable, findings);
  }
}

void check_variables(const ModelDescription& model, Findings findings) {
  std::size_t independents = 0;
  for (const auto& variable : model.variables) {
    check_combination(variable, findings);
    check_start(model, variable, findings);
    if (variable.variability == Variability::continuous && variable.type != Type::real)
      findings.error(fmt::format("{} is continuous, but not a Real", quoted(variable)), "use variability discrete");
    if (variable.derivative_of) {
      const auto& state = model.variables[*variable.derivative_of];
      if (variable.type != Type::real || state.type != Type::real || variable.variability != Variability::continuous)
        findings.error(
            fmt::format("{} as derivative of {}: both must be continuous Reals", quoted(variable), quoted(state)),
            "remove the attribute derivative");
    }
    if (variable.causality == Causality::independent) {
      if (variable.type != Type::real)
        findings.error(fmt::format("the independent variable {} is not a Real", quoted(variable)),
                       "declare it as Real");
      if (++independents == 2)
        findings.error(fmt::format("{} is a second independent variable", quoted(variable)), "keep one");
    }
  }
}

void check_names(const ModelDescription& model, Findings findings) {
  std::set<std::string_view> names;
  std::size_t odd = 0;
  for (const auto& variable : model.variables) {
    if (variable.name.empty()) findings.error("a variable has no name", "name it");
    if (!names.insert(variable.name).second)
      findings.error(fmt::format("{} occurs twice", quoted(variable)), "rename one");
    if (std::ranges::any_of(variable.name, [](unsigned char c) { return c < 0x20 || c == 0x7f; }))
      findings.error(fmt::format("{} has a control character in its name", quoted(variable)), "rename it");
    if (!model.structured_names || is_structured_name(variable.name)) continue;
    constexpr std::size_t kShown = 5;
    if (++odd <= kShown)
      findings.error(fmt::format("{} is not a structured name", quoted(variable)),
                     "write names like a.b[1].c, quote other names ('a b'), or use variableNamingConvention flat");
  }
  if (odd > 5) findings.error(fmt::format("{} names are not structured", odd), "use variableNamingConvention flat");
}

void check_aliases(const ModelDescription& model, Findings findings) {
  std::map<std::pair<Type, std::uint32_t>, std::vector<const Variable*>> sets;
  for (const auto& variable : model.variables) {
    const auto base = variable.type == Type::enumeration ? Type::integer : variable.type;
    sets[{base, variable.value_reference}].push_back(&variable);
  }
  for (const auto& [key, variables] : sets) {
    const auto& first = *variables.front();
    std::size_t settable = 0;
    for (const auto* variable : variables) {
      const bool sets_it = variable->causality == Causality::input || variable->causality == Causality::parameter ||
                           (has_start(*variable) && variable->variability != Variability::constant);
      settable += sets_it ? 1 : 0;
      if (variable->unit != first.unit)
        findings.error(fmt::format("{} [{}] and {} [{}] share a value reference, but not their unit", quoted(first),
                                   first.unit, quoted(*variable), variable->unit),
                       "aliases have one unit; show another one by displayUnit");
      if ((variable->variability == Variability::constant) != (first.variability == Variability::constant))
        findings.error(fmt::format("{} and {} share a value reference, but only one is constant", quoted(first),
                                   quoted(*variable)),
                       "aliases are all constant, or none is");
    }
    if (settable > 1)
      findings.error(fmt::format("{} and {} other{} share value reference {}, and more than one of them can be set",
                                 quoted(first), variables.size() - 1, variables.size() == 2 ? "" : "s", key.second),
                     "set start, and causality input or parameter, for one of the aliases only");
  }
}

void check_structure(const ModelDescription& model, Findings findings) {
  for (const auto& fault : model.structure_faults)
    findings.error("modelDescription.xml, " + fault,
                   "write the index of the variable in ModelVariables, which starts at 1");
  std::set<std::size_t> outputs;
  std::set<std::size_t> initial_unknowns;
  std::set<std::size_t> states;
  for (const auto& unknown : model.derivatives) {
    states.insert(unknown.variable);
    const auto& derivative = model.variables[unknown.variable];
    if (!derivative.derivative_of)
      findings.error(fmt::format("Derivatives lists {}, which has no attribute derivative", quoted(derivative)),
                     "add the attribute derivative, the index of the state, to the variable");
    else
      states.insert(*derivative.derivative_of);
  }
  for (std::size_t i = 0; i < model.variables.size(); ++i) {
    const auto& variable = model.variables[i];
    const bool unknown_at_start = variable.initial && *variable.initial != Initial::exact;
    if (variable.causality == Causality::output) outputs.insert(i);
    if (variable.causality == Causality::calculated_parameter ||
        (unknown_at_start && (variable.causality == Causality::output || states.contains(i))))
      initial_unknowns.insert(i);
  }
  compare_unknowns(model, "ModelStructure/Outputs", model.outputs, outputs, "all variables of causality output",
                   findings);
  compare_unknowns(model, "ModelStructure/InitialUnknowns", model.initial_unknowns, initial_unknowns,
                   "outputs, states and derivatives of initial approx or calculated, and calculated parameters",
                   findings);
}

void check_osmp(const ModelDescription& model, Findings findings) {
  std::map<std::string, std::vector<const Variable*>> wholes;
  for (const auto& variable : model.variables)
    if (variable.osmp) wholes[variable.osmp->name].push_back(&variable);
  for (const auto& [name, parts] : wholes) {
    std::set<std::string> roles;
    for (const auto* part : parts) {
      roles.insert(part->osmp->role);
      if (part->type != Type::integer || part->causality != parts.front()->causality ||
          part->variability != parts.front()->variability)
        findings.error(fmt::format("OSMP binary \"{}\": its part {} differs in type, causality or variability", name,
                                   quoted(*part)),
                       "make all three Integers of one causality and variability");
      const auto* start = std::get_if<std::int64_t>(&part->start);
      if (start != nullptr && *start != 0)
        findings.error(fmt::format("OSMP binary \"{}\": {} starts at {}", name, quoted(*part), *start),
                       "set start to 0, which means that there is no buffer");
    }
    if (parts.size() != 3 || roles != std::set<std::string>{"base.lo", "base.hi", "size"})
      findings.error(fmt::format("OSMP binary \"{}\" has the parts {}", name, fmt::join(roles, ", ")),
                     "it needs base.lo, base.hi and size, each once");
  }
}

}  // namespace mebots::check
