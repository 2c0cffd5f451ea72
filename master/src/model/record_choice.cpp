// SPDX-License-Identifier: Apache-2.0
#include "model/resolved_system.hpp"

#include "mebots/nearest_names.hpp"
#include "model/value_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <set>
#include <unordered_map>

namespace mebots::master {
namespace {

using modeldesc::Causality;
using modeldesc::Type;
using modeldesc::Variability;
using modeldesc::Variable;

/// A set of patterns, and whether each of them has matched a name.
///
/// A name is compared only with patterns that begin like the name, up to their first * or ?. The search needs one
/// look-up for each length of such a beginning, even in a long list of patterns such as "cell.branch[7].*".
class Patterns {
 public:
  explicit Patterns(const std::vector<RecordPattern>& patterns) : patterns_(&patterns), used_(patterns.size(), false) {
    for (std::size_t i = 0; i < patterns.size(); ++i) {
      const auto beginning = literal_beginning(patterns[i].pattern);
      if (by_beginning_[beginning].empty()) lengths_.insert(beginning.size());
      by_beginning_[beginning].push_back(i);
    }
  }

  enum class Fit { none, pattern, outright };

  /// Returns `outright` if a pattern equals the name, or `pattern` if a pattern matches it.
  Fit fit(std::string_view name) const {
    auto best = Fit::none;
    for_each_fitting(name, [&](std::size_t i) {
      if (name == (*patterns_)[i].pattern) {
        best = Fit::outright;
      } else if (best == Fit::none) {
        best = Fit::pattern;
      }
    });
    return best;
  }
  void use(std::string_view name) {
    for_each_fitting(name, [&](std::size_t i) { used_[i] = true; });
  }
  void check(const std::string& what, const std::vector<std::string>& names) const {
    for (std::size_t i = 0; i < used_.size(); ++i) {
      if (used_[i]) continue;
      const auto& [pattern, place] = (*patterns_)[i];
      throw InputError(ErrorCode::unknown_name,
                       fmt::format("{}: {} fits '{}'. {}", place, what, pattern, suggest(pattern, names)));
    }
  }

  void refuse(const std::string& name, std::string_view why) const {
    for (const auto& [pattern, place] : *patterns_) {
      if (pattern == name) throw InputError(ErrorCode::wrong_type, fmt::format("{}: '{}' {}", place, name, why));
    }
  }

 private:
  static std::string_view literal_beginning(std::string_view pattern) {
    return pattern.substr(0, std::min(pattern.find_first_of("*?"), pattern.size()));
  }

  template <typename Work>
  void for_each_fitting(std::string_view name, Work work) const {
    for (const auto length : lengths_) {
      if (length > name.size()) break;
      const auto found = by_beginning_.find(name.substr(0, length));
      if (found == by_beginning_.end()) continue;
      for (const auto i : found->second) {
        if (fits(name, (*patterns_)[i].pattern)) work(i);
      }
    }
  }

  const std::vector<RecordPattern>* patterns_;
  std::vector<bool> used_;
  std::unordered_map<std::string_view, std::vector<std::size_t>> by_beginning_;  // patterns by their literal beginnings
  std::set<std::size_t> lengths_;                                                // lengths of the literal beginnings
};

void for_each_variable(const ResolvedSystem& system,
                       const std::function<void(const ResolvedVariable&, const std::string&)>& work) {
  for (std::size_t i = 0; i < system.instances.size(); ++i) {
    const auto& model = *system.instances[i].model;
    for (const auto& variable : model.variables) {
      if (is_osmp_part(model, variable)) continue;  // its pointer would become invalid
      const ResolvedVariable candidate{i, &variable};
      work(candidate, system.text(candidate));
    }
  }
}

}  // namespace

bool fits(std::string_view text, std::string_view pattern) {
  // Matches greedily. If the rest of the pattern does not match, the last * matches one more character.
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
  static const std::vector<RecordPattern> kNoPatterns;
  const auto& record = system.description->record;
  Patterns wanted(record.patterns ? *record.patterns : kNoPatterns);
  Patterns unwanted(record.exclude);
  std::vector<ResolvedVariable> chosen;
  std::vector<std::string> names;
  for_each_variable(system, [&](const ResolvedVariable& candidate, const std::string& name) {
    const auto& variable = *candidate.variable;
    if (variable.type == modeldesc::Type::clock) {
      wanted.refuse(name, "is a Clock, which has no column; record a variable that belongs to it");
      return;
    }
    const bool shown =
        variable.causality == Causality::output || (record.locals && variable.causality == Causality::local);
    if (is_clocked(variable) && !system.instances[candidate.instance].clocks_tick) return;
    const bool output = shown && (is_number(variable.type) || (variable.type == Type::string && record.texts));
    const auto fit = wanted.fit(name);
    // A name without * selects any variable. A pattern with * selects outputs, but no Binaries. It selects Strings only
    // if the config requests them, because reading them may be slow.
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
  wanted.check("no variable that can be recorded", names);
  unwanted.check("no recorded variable", names);
  return chosen;
}

std::vector<ResolvedVariable> recorded_parameters(const ResolvedSystem& system) {
  Patterns wanted(system.description->record.parameters);
  std::vector<ResolvedVariable> chosen;
  std::vector<std::string> names;
  for_each_variable(system, [&](const ResolvedVariable& candidate, const std::string& name) {
    const auto causality = candidate.variable->causality;
    const bool parameter = causality == Causality::parameter || causality == Causality::calculated_parameter ||
                           causality == Causality::structural_parameter ||
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
