// SPDX-License-Identifier: Apache-2.0
#include "system/record_choice.hpp"

#include "mebots/nearest_names.hpp"

#include <fmt/format.h>

#include <functional>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Type;
using modeldesc::Variability;
using modeldesc::Variable;

/// Some patterns, and which of them have fitted anything.
class Patterns {
 public:
  explicit Patterns(const std::vector<RecordPattern>& patterns) : patterns_(&patterns), used_(patterns.size(), false) {}

  enum class Fit { none, pattern, outright };

  /// Whether a pattern fits the name, or is the name.
  Fit fit(std::string_view name) {
    auto best = Fit::none;
    for (std::size_t i = 0; i < used_.size(); ++i) {
      const auto& pattern = (*patterns_)[i].pattern;
      if (!fits(name, pattern)) continue;
      if (name == pattern) {
        best = Fit::outright;
      } else if (best == Fit::none) {
        best = Fit::pattern;
      }
    }
    return best;
  }
  /// What fits `name` has found something.
  void use(std::string_view name) {
    for (std::size_t i = 0; i < used_.size(); ++i) used_[i] = used_[i] || fits(name, (*patterns_)[i].pattern);
  }
  /// Throws for a pattern that found nothing.
  void check(const std::string& what, const std::vector<std::string>& names) const {
    for (std::size_t i = 0; i < used_.size(); ++i) {
      if (used_[i]) continue;
      const auto& [pattern, place] = (*patterns_)[i];
      throw InputError(ErrorCode::unknown_name,
                       fmt::format("{}: {} fits '{}'. {}", place, what, pattern, suggest(pattern, names)));
    }
  }

 private:
  const std::vector<RecordPattern>* patterns_;
  std::vector<bool> used_;
};

void for_each_variable(const ResolvedSystem& system,
                       const std::function<void(const ResolvedVariable&, const std::string&)>& work) {
  for (std::size_t i = 0; i < system.instances.size(); ++i) {
    const auto& model = system.instances[i].fmu->description();
    for (const auto& variable : model.variables) {
      if (is_osmp_part(model, variable)) continue;  // an address means nothing to anybody later
      const ResolvedVariable candidate{i, &variable};
      work(candidate, system.text(candidate));
    }
  }
}

}  // namespace

bool fits(std::string_view text, std::string_view pattern) {
  // Greedy with one way back: the last star takes one more character whenever the rest does not fit.
  std::size_t t = 0;
  std::size_t p = 0;
  std::size_t star = std::string_view::npos;
  std::size_t after_star = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      after_star = t;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t])) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++after_star;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

std::vector<ResolvedVariable> recorded_variables(const ResolvedSystem& system) {
  static const std::vector<RecordPattern> kNone;
  const auto& record = system.description->record;
  Patterns wanted(record.patterns ? *record.patterns : kNone);
  Patterns unwanted(record.exclude);
  std::vector<ResolvedVariable> chosen;
  std::vector<std::string> names;
  for_each_variable(system, [&](const ResolvedVariable& candidate, const std::string& name) {
    const auto& variable = *candidate.variable;
    const bool output = variable.causality == Causality::output && (variable.type != Type::string || record.texts);
    const auto fit = wanted.fit(name);
    // A pattern that names one variable outright may name any; one with a star means outputs, and texts
    // only where the config wants them. An FMU may make a text at some cost when it is read.
    const bool by_pattern = record.patterns ? fit == Patterns::Fit::pattern : true;
    if (output || variable.causality == Causality::output) names.push_back(name);
    if (fit != Patterns::Fit::outright && !(output && by_pattern)) return;
    wanted.use(name);
    if (unwanted.fit(name) == Patterns::Fit::none) {
      chosen.push_back(candidate);
    } else {
      unwanted.use(name);
    }
  });
  wanted.check("nothing that can be recorded", names);
  unwanted.check("nothing that is recorded", names);
  return chosen;
}

std::vector<ResolvedVariable> recorded_parameters(const ResolvedSystem& system) {
  Patterns wanted(system.description->record.parameters);
  std::vector<ResolvedVariable> chosen;
  std::vector<std::string> names;
  for_each_variable(system, [&](const ResolvedVariable& candidate, const std::string& name) {
    const auto causality = candidate.variable->causality;
    const bool parameter = causality == Causality::parameter || causality == Causality::calculated_parameter ||
                           candidate.variable->variability == Variability::constant;
    if (!parameter) return;
    names.push_back(name);
    if (wanted.fit(name) == Patterns::Fit::none) return;
    wanted.use(name);
    chosen.push_back(candidate);
  });
  wanted.check("no parameter", names);
  return chosen;
}

}  // namespace mebots::master
