// SPDX-License-Identifier: Apache-2.0
#include "io/study/study_file.hpp"

#include "mebots/data/document.hpp"
#include "mebots/data/object.hpp"
#include "mebots/file_kind.hpp"
#include "mebots/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master::study {
namespace {

using data::Limits;
using data::Node;
using data::Object;

// Maximum number of missions, draws and designs. More do not fit into memory.
constexpr std::int64_t kMost = 100'000'000;

/// The names to which sections of a study refer.
struct Names {
  std::string design_kind;
  std::vector<std::string> factors;     // empty for a design of kind `list`, whose file contains the factors
  std::vector<std::string> draws;       // names of variables
  std::vector<std::string> objectives;  // labels of objectives
  std::vector<std::string> successes;   // labels of outcome objectives
  bool compared = false;                // true if an objective or a constraint compares designs
};

auto count_from(std::int64_t least) {
  return data::whole_number(least, kMost);
}

/// Reads a key that must be true.
bool read_mark(const Node& node) {
  if (!node.flag()) node.fail(ErrorCode::invalid_value, "this key must be true; remove it for the other case");
  return true;
}

std::string read_known(const Node& node, std::string_view what, const std::vector<std::string>& known) {
  auto name = node.text();
  if (std::ranges::find(known, name) == known.end()) node.fail_unknown(what, name, known);
  return name;
}

void check_scalar(const Node& node) {
  if (node.is_number() || node.is(data::Kind::boolean) || node.is(data::Kind::text)) return;
  node.fail(ErrorCode::wrong_type,
            fmt::format("a number, true, false or a text is expected here, not {}", node.shown()));
}

void check_choice(const Node& node) {
  const auto elements = node.elements();
  if (elements.empty()) node.fail(ErrorCode::invalid_value, "at least one value is needed");
  std::set<std::string> seen;
  for (const auto& element : elements) {
    element.attempt([&] {
      check_scalar(element);
      if (!seen.insert(element.shown()).second) {
        element.fail(ErrorCode::duplicate_name, fmt::format("the value {} occurs twice", element.shown()));
      }
    });
  }
}

void check_range(const Node& node, const Limits& limits, bool whole) {
  const auto elements = node.elements();
  if (elements.size() != 2) node.fail(ErrorCode::invalid_value, "two numbers are expected: the least and the greatest");
  std::array<double, 2> bounds{};
  for (std::size_t i = 0; i < 2; ++i) {
    bounds.at(i) = elements[i].number(limits);
    if (whole) static_cast<void>(elements[i].whole_number(-kMost * kMost / 10, kMost * kMost / 10));
  }
  if (whole ? bounds[0] <= bounds[1] : bounds[0] < bounds[1]) return;
  node.fail(ErrorCode::value_out_of_range, fmt::format("the first must be less than the second, not {}", node.shown()));
}

void check_normal(const Node& node) {
  const auto elements = node.elements();
  if (elements.size() != 2) node.fail(ErrorCode::invalid_value, "two numbers are expected: mean, standard deviation");
  static_cast<void>(elements[0].number());
  static_cast<void>(elements[1].number(Limits::positive()));
}

template <std::size_t N>
void require_one_of(const Object& object, const std::array<std::string_view, N>& words) {
  std::string list;
  std::size_t given = 0;
  for (const auto word : words) {
    list += (list.empty() ? "" : ", ") + std::string(word);
    given += object.has(word) ? 1 : 0;
  }
  if (given != 1) object.node().complain(ErrorCode::missing_key, fmt::format("exactly one is expected of: {}", list));
}

constexpr std::array<std::string_view, 3> kSpans = {"uniform", "log_uniform", "integer"};

void read_spans(Object& object) {
  object.visit_if("uniform", [](const Node& range) { check_range(range, {}, false); });
  object.visit_if("log_uniform", [](const Node& range) { check_range(range, Limits::positive(), false); });
  object.visit_if("integer", [](const Node& range) { check_range(range, {}, true); });
}

void check_distribution(const Node& node) {
  Object object(node);
  read_spans(object);
  object.visit_if("normal", &check_normal);
  object.visit_if("choice", &check_choice);
  object.finish();
  require_one_of(object, std::array<std::string_view, 5>{"uniform", "log_uniform", "integer", "normal", "choice"});
}

void check_options(const Node& node) {
  const auto options = node.members();
  if (options.empty()) node.fail(ErrorCode::invalid_value, "at least one option is needed");
  for (const auto& option : options) {
    option.value.attempt([&] {
      for (const auto& setting : option.value.members()) {
        setting.value.attempt([&] { check_scalar(setting.value); });
      }
    });
  }
}

/// Checks a factor of the design: a list of values, a span of numbers, or options that set several parameters.
void check_factor(const Node& node, const std::string& kind) {
  if (node.is(data::Kind::list)) return check_choice(node);
  Object object(node);
  read_spans(object);
  object.visit_if("options", &check_options);
  object.finish();
  require_one_of(object, std::array<std::string_view, 4>{"options", "uniform", "log_uniform", "integer"});
  if (kind == "grid" && !object.has("options")) {
    node.complain(ErrorCode::invalid_value, "a grid needs a list of values here; spans are for the other designs");
  }
}

/// Checks `when` or `only` of a condition, such as {factor: values} or {factor: {"min": a, "max": b}}.
void check_subset(const Node& node, const std::vector<std::string>& factors) {
  if (node.members().empty()) node.fail(ErrorCode::invalid_value, "at least one factor is needed");
  for (const auto& [name, value] : node.members()) {
    value.attempt([&, &name = name, &value = value] {
      if (std::ranges::find(factors, name) == factors.end()) value.fail_unknown("the factor", name, factors);
      if (value.is(data::Kind::list)) return check_choice(value);
      Object bounds(value);
      double least = -std::numeric_limits<double>::infinity();
      double most = std::numeric_limits<double>::infinity();
      const bool has_least = bounds.read_if("min", least, data::number());
      const bool has_most = bounds.read_if("max", most, data::number());
      bounds.finish();
      if (bounds.sound() && !has_least && !has_most) {
        value.fail(ErrorCode::missing_key, "min, max or both are needed");
      }
    });
  }
}

void check_condition(const Node& node, const std::vector<std::string>& factors) {
  Object condition(node);
  const auto subset = [&](const Node& part) { check_subset(part, factors); };
  condition.visit("when", subset);
  condition.visit("only", subset);
  condition.finish();
}

/// The required and permitted keys of a kind of design, in addition to `kind`.
struct DesignKind {
  std::string_view name;
  std::vector<std::string_view> needs;
  std::vector<std::string_view> takes;
};

const std::vector<DesignKind>& design_kinds() {
  static const std::vector<DesignKind> kKinds = {
      {"grid", {"factors"}, {"conditions"}},
      {"list", {"file"}, {}},
      {"latin_hypercube", {"factors", "points"}, {"seed", "conditions"}},
      {"sobol", {"factors", "points"}, {"seed", "conditions"}},
      {"random", {"factors", "points"}, {"seed", "conditions"}},
      {"sensitivity", {"factors", "points", "method"}, {"seed"}},
      {"search", {"factors", "points", "rounds"}, {"seed", "method"}},
  };
  return kKinds;
}

void check_keys_of_kind(const Object& design, const DesignKind& kind) {
  for (const auto need : kind.needs) {
    if (design.has(need)) continue;
    design.node().complain(ErrorCode::missing_key, fmt::format("a design '{}' needs the key '{}'", kind.name, need));
  }
  for (const std::string_view key : {"factors", "file", "points", "seed", "method", "rounds", "conditions"}) {
    const bool fits = std::ranges::find(kind.needs, key) != kind.needs.end() ||
                      std::ranges::find(kind.takes, key) != kind.takes.end();
    if (design.has(key) && !fits) {
      design.node().at(key).complain(ErrorCode::unknown_key, fmt::format("a design '{}' has no '{}'", kind.name, key));
    }
  }
}

void check_design(const Node& node, const std::filesystem::path& folder, Names& names) {
  Object design(node);
  std::vector<std::string> known;
  for (const auto& kind : design_kinds()) known.emplace_back(kind.name);
  design.read("kind", names.design_kind,
              [&](const Node& kind) { return read_known(kind, "the kind of design", known); });
  design.visit_if("factors", [&](const Node& factors) {
    if (factors.members().empty()) factors.fail(ErrorCode::invalid_value, "at least one factor is needed");
    for (const auto& [name, value] : factors.members()) {
      names.factors.push_back(name);
      value.attempt([&, &value = value] { check_factor(value, names.design_kind); });
    }
  });
  std::int64_t number = 0;
  std::string text;
  design.read_if("points", number, count_from(1));
  design.read_if("rounds", number, count_from(1));
  design.read_if("seed", number, count_from(0));
  design.read_if("file", text, [&](const Node& file) {
    auto name = file.readable_text();
    if (!is_file(folder / name)) {
      file.fail(ErrorCode::file_not_found, fmt::format("there is no file {}; paths are relative to the study", name));
    }
    return name;
  });
  design.read_if("method", text, [&](const Node& method) {
    const bool search = names.design_kind == "search";
    return read_known(method, "the method",
                      search ? std::vector<std::string>{"nsga2", "tpe"} : std::vector<std::string>{"sobol", "morris"});
  });
  design.visit_if("conditions", [&](const Node& conditions) {
    for (const auto& one : conditions.elements()) one.attempt([&] { check_condition(one, names.factors); });
  });
  design.finish();
  const auto kind = std::ranges::find(design_kinds(), names.design_kind, &DesignKind::name);
  if (kind != design_kinds().end()) check_keys_of_kind(design, *kind);
}

void check_draws(const Node& node, Names& names) {
  Object draws(node);
  std::int64_t number = 0;
  draws.read("replicates", number, count_from(1));
  draws.read_if("seed", number, count_from(0));
  draws.visit_if("variables", [&](const Node& variables) {
    for (const auto& [name, value] : variables.members()) {
      names.draws.push_back(name);
      value.attempt([&, &name = name, &value = value] {
        if (std::ranges::find(names.factors, name) != names.factors.end()) {
          value.fail(ErrorCode::duplicate_name, fmt::format("'{}' is already a factor", name));
        }
        check_distribution(value);
      });
    }
  });
  draws.finish();
}

void check_outcomes(const Node& node) {
  if (node.is(data::Kind::text)) {
    static_cast<void>(node.readable_text());
    return;
  }
  const auto elements = node.elements();
  if (elements.empty()) node.fail(ErrorCode::invalid_value, "at least one outcome is needed");
  for (const auto& element : elements) element.attempt([&] { static_cast<void>(element.readable_text()); });
}

void check_end_reasons(const Node& node) {
  const std::vector<std::string> known = {"stop_time", "stop_condition", "terminated", "failed"};
  const auto check = [&](const Node& reason) { static_cast<void>(read_known(reason, "the end reason", known)); };
  if (node.is(data::Kind::text)) return check(node);
  const auto elements = node.elements();
  if (elements.empty()) node.fail(ErrorCode::invalid_value, "at least one end reason is needed");
  for (const auto& element : elements) element.attempt([&] { check(element); });
}

constexpr std::array<std::string_view, 6> kSources = {"outcome", "end_reason", "summary",
                                                      "final",   "series",     "expression"};

/// True if the objective is 0 or 1 in each mission.
bool is_share(const Node& objective) {
  return objective.has("outcome") || objective.has("end_reason");
}

void check_objective(const Node& node, const Names& names) {
  Object objective(node);
  std::string text;
  bool mark = false;
  double number = 0;
  objective.visit_if("outcome", &check_outcomes);
  objective.visit_if("end_reason", &check_end_reasons);
  for (const std::string_view source : {"summary", "final", "series", "expression", "unit"}) {
    objective.read_if(source, text, &Node::readable_text);
  }
  objective.read_if("of", text, [](const Node& of) {
    return read_known(of, "the reduction",
                      {"min", "max", "mean", "first", "last", "median", "p5", "p95", "first_true"});
  });
  objective.read_if("percentile", number, [&](const Node& percentile) {
    if (is_share(node)) percentile.fail(ErrorCode::invalid_value, "an objective that is a share has no percentile");
    const double read = percentile.number();
    if (read <= 0 || read >= 100) {
      percentile.fail(ErrorCode::value_out_of_range,
                      fmt::format("a percentile must be above 0 and below 100, not {}", percentile.shown()));
    }
    return read;
  });
  objective.read_if("minimize", mark, &read_mark);
  objective.read_if("maximize", mark, &read_mark);
  objective.read_if("tolerance", number, data::number(Limits::at_least(0)));
  objective.read_if("where", text, [&](const Node& where) {
    return read_known(where, "the objective of an outcome or an end reason", names.successes);
  });
  objective.finish();
  require_one_of(objective, kSources);
  if (objective.has("series") != objective.has("of")) {
    node.complain(ErrorCode::missing_key,
                  "'series' (a variable) and 'of' (the reduction of its values) need each other");
  }
  if (objective.has("minimize") && objective.has("maximize")) {
    node.complain(ErrorCode::invalid_value, "either 'minimize' or 'maximize', not both");
  }
}

void check_objectives(const Node& node, Names& names) {
  const auto members = node.members();
  if (members.empty()) node.fail(ErrorCode::invalid_value, "at least one objective is needed");
  for (const auto& [label, value] : members) {
    names.objectives.push_back(label);
    if (is_share(value)) names.successes.push_back(label);
    names.compared |= value.has("minimize") || value.has("maximize");
  }
  for (const auto& [label, value] : members) {
    value.attempt([&, &label = label, &value = value] {
      const bool taken = std::ranges::find(names.factors, label) != names.factors.end() ||
                         std::ranges::find(names.draws, label) != names.draws.end();
      if (taken) value.fail(ErrorCode::duplicate_name, fmt::format("'{}' is already a factor or a draw", label));
      check_objective(value, names);
    });
  }
}

void read_side(Object& object, const Limits& limits = {}) {
  double bound = 0;
  object.read_if("above", bound, data::number(limits));
  object.read_if("below", bound, data::number(limits));
}

/// Returns the range for the bound of an objective. It is 0 to 1 for an outcome objective, whose value is a fraction of
/// missions.
Limits limits_of(const std::string& label, const Names& names) {
  const bool is_share = std::ranges::find(names.successes, label) != names.successes.end();
  return is_share ? Limits::between(0, 1) : Limits{};
}

void check_constraints(const Node& node, Names& names) {
  names.compared |= !node.members().empty();
  for (const auto& [label, value] : node.members()) {
    value.attempt([&, &label = label, &value = value] {
      if (std::ranges::find(names.objectives, label) == names.objectives.end()) {
        value.fail_unknown("the objective", label, names.objectives);
      }
      Object side(value);
      read_side(side, limits_of(label, names));
      side.finish();
      require_one_of(side, std::array<std::string_view, 2>{"above", "below"});
    });
  }
}

void check_limits(const Node& node) {
  Object limits(node);
  double time_s = 0;
  std::int64_t number = 0;
  limits.read_if("processor_time", time_s, data::number(Limits::positive()));
  limits.read_if("failures", number, count_from(1));
  limits.finish();
}

void check_stop(const Node& node, const Names& names) {
  Object stop(node);
  std::string label;
  double width = 0;
  bool mark = false;
  stop.read("objective", label, [&](const Node& name) { return read_known(name, "the objective", names.objectives); });
  stop.read_if("width", width, data::number(Limits::positive()));
  read_side(stop, limits_of(label, names));
  stop.read_if("best", mark, &read_mark);
  stop.finish();
  require_one_of(stop, std::array<std::string_view, 4>{"width", "above", "below", "best"});
}

void check_rounds(const Node& node, const Names& names) {
  Object rounds(node);
  std::int64_t number = 0;
  double error = 0;
  bool mark = false;
  rounds.read("size", number, count_from(1));
  rounds.read_if("error", error, data::number({0, 0.5, false}));
  rounds.read_if("racing", mark, &read_mark);
  rounds.visit_if("stop", [&](const Node& stop) { check_stop(stop, names); });
  rounds.finish();
  if (mark && !names.compared) {
    node.at("racing").complain(
        ErrorCode::invalid_value,
        "a race needs something to compare: add 'minimize' or 'maximize' to an objective, or add constraints");
  }
}

/// Checks names of factors or draws, which must all differ. If `known_all` is false, `known` is incomplete, because the
/// factors of a design of kind `list` are in a separate file.
void check_names(const Node& node, std::string_view what, const std::vector<std::string>& known, bool known_all) {
  const auto elements = node.elements();
  if (elements.empty()) node.fail(ErrorCode::invalid_value, "at least one name is needed");
  std::set<std::string> seen;
  for (const auto& element : elements) {
    element.attempt([&] {
      const auto name = known_all ? read_known(element, what, known) : element.readable_text();
      if (!seen.insert(name).second) {
        element.fail(ErrorCode::duplicate_name, fmt::format("'{}' occurs twice", name));
      }
    });
  }
}

void check_fork(const Node& node, const Names& names) {
  Object fork(node);
  double time_s = 0;
  auto known = names.factors;
  known.insert(known.end(), names.draws.begin(), names.draws.end());
  fork.read("at", time_s, data::number(Limits::positive()));
  fork.visit("variables", [&](const Node& variables) {
    check_names(variables, "the factor or draw", known, names.design_kind != "list");
  });
  fork.finish();
}

void check_levels(const Node& node) {
  const auto elements = node.elements();
  if (elements.empty()) node.fail(ErrorCode::invalid_value, "at least one level is needed");
  std::vector<double> levels;
  levels.reserve(elements.size());
  for (const auto& element : elements) levels.push_back(element.number());
  const bool rises = std::ranges::adjacent_find(levels, std::ranges::greater_equal()) == levels.end();
  const bool falls = std::ranges::adjacent_find(levels, std::ranges::less_equal()) == levels.end();
  if (rises || falls) return;
  node.fail(ErrorCode::invalid_value, fmt::format("levels must all rise or all fall, not {}", node.shown()));
}

void check_splitting(const Node& node, const Names& names) {
  Object splitting(node);
  std::string text;
  std::int64_t number = 0;
  splitting.read("score", text, &Node::readable_text);
  splitting.visit_if("levels", &check_levels);
  read_side(splitting);
  splitting.read("missions", number, count_from(2));
  splitting.visit("reseed", [&](const Node& reseed) { check_names(reseed, "the draw", names.draws, true); });
  splitting.finish();
  require_one_of(splitting, std::array<std::string_view, 3>{"levels", "above", "below"});
}

/// Checks the other keys of a study with `splitting`, which estimates only the probability of a rare event.
void check_alone(const Object& study, const Names& names) {
  const auto& node = study.node();
  for (const std::string_view key : {"objectives", "constraints", "rounds", "fork", "results"}) {
    if (study.has(key)) {
      node.at(key).complain(ErrorCode::invalid_value,
                            fmt::format("'{}' cannot be used with 'splitting', whose result is a probability", key));
    }
  }
  if (!study.has("draws")) {
    node.complain(ErrorCode::missing_key, "'splitting' needs 'draws': its key replicates is the number of estimates");
  }
  if (names.design_kind == "search" || names.design_kind == "sensitivity") {
    node.at("design").complain(ErrorCode::invalid_value,
                               fmt::format("a design '{}' cannot be used with 'splitting'", names.design_kind));
  }
}

void check_study(const Node& root, const std::filesystem::path& folder) {
  Object study(root);
  study.comment("$schema");
  study.comment("text");
  Names names;
  std::string mission;
  study.read("mission", mission, [&](const Node& node) {
    auto name = node.readable_text();
    if (!is_file(folder / name)) {
      node.fail(ErrorCode::file_not_found, fmt::format("there is no file {}; paths are relative to the study", name));
    }
    return name;
  });
  study.visit("design", [&](const Node& node) { check_design(node, folder, names); });
  study.visit_if("draws", [&](const Node& node) { check_draws(node, names); });
  const auto objectives = [&](const Node& node) { check_objectives(node, names); };
  if (study.has("splitting")) {
    study.visit("splitting", [&](const Node& node) { check_splitting(node, names); });
    study.visit_if("objectives", objectives);
  } else {
    study.visit("objectives", objectives);
  }
  study.visit_if("uncertainty", [&](const Node& node) {
    static_cast<void>(read_known(node, "the kind of uncertainty", {"calibration"}));
    if (study.has("draws")) return;
    node.complain(ErrorCode::missing_key,
                  "'uncertainty' needs 'draws': its key replicates is the number of draws of each design");
  });
  study.visit_if("constraints", [&](const Node& node) { check_constraints(node, names); });
  study.visit_if("limits", &check_limits);
  study.visit_if("rounds", [&](const Node& node) { check_rounds(node, names); });
  study.visit_if("fork", [&](const Node& node) { check_fork(node, names); });
  bool results = false;
  study.read_if("results", results, &read_mark);
  study.finish();
  if (results && study.has("fork")) {
    root.at("results").complain(
        ErrorCode::invalid_value,
        "'results' cannot be used with 'fork': a mission that begins at the fork has no files of the time before it");
  }
  if (study.has("splitting")) check_alone(study, names);
}

}  // namespace

nlohmann::ordered_json read(const std::filesystem::path& file) {
  return read(text_of(file), file);
}

nlohmann::ordered_json read(const std::string& text, const std::filesystem::path& file) {
  const auto folder = std::filesystem::absolute(file).parent_path();
  data::Document(text, file.string()).read([&](const Node& root) { check_study(root, folder); });
  auto study = nlohmann::ordered_json::parse(text);
  study["mission"] = (folder / study["mission"].get<std::string>()).lexically_normal().string();
  auto& design = study["design"];
  if (design.contains("file")) {
    design["file"] = (folder / design["file"].get<std::string>()).lexically_normal().string();
  }
  return study;
}

}  // namespace mebots::master::study
