// SPDX-License-Identifier: Apache-2.0
#include "cases/run_case.hpp"

#include "base/time.hpp"
#include "io/find_fmu.hpp"
#include "io/signal_file.hpp"
#include "mebots/assert.hpp"
#include "mebots/nearest_names.hpp"
#include "record/sink/memory_sink.hpp"
#include "resolve/resolve.hpp"
#include "run/run.hpp"
#include "slave/discrete_link.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>

namespace mebots::master::cases {
namespace {

using modeldesc::Type;
using modeldesc::Variable;

struct Expected {
  const Variable* variable = nullptr;
  std::string recorded;  // name of the variable in the results
  std::shared_ptr<const Signal> signal;
};

/// Finds a variable by its name "y", or by its name "instance.y" in results.csv.
const Variable* find_variable(const modeldesc::ModelDescription& model, const std::string& instance,
                              const std::string& title) {
  if (const auto* variable = model.find(title)) return variable;
  return title.starts_with(instance + ".") ? model.find(title.substr(instance.size() + 1)) : nullptr;
}

[[noreturn]] void fail_unknown(const SignalFile& file, const modeldesc::ModelDescription& model,
                               const std::string& title) {
  std::vector<std::string> names;
  for (const auto& variable : model.variables) names.push_back(variable.name);
  throw InputError(ErrorCode::unknown_name,
                   fmt::format("{}: the FMU has no variable '{}'. {}", file.name(), title, suggest(title, names)));
}

std::vector<Expected> read_expected(const std::filesystem::path& path, const modeldesc::ModelDescription& model,
                                    const std::string& instance) {
  SignalFile file(path, path.string(), "");
  std::vector<Expected> columns;
  std::vector<WantedSignal> wanted;
  for (std::size_t i = 0; i < file.titles().size(); ++i) {
    if (i == file.time_column()) continue;
    const auto& title = file.titles()[i];
    const auto* variable = find_variable(model, instance, title.name);
    if (variable == nullptr) fail_unknown(file, model, title.name);
    if (!title.unit.empty() && title.unit != variable->unit) {
      throw InputError(
          ErrorCode::wrong_unit,
          fmt::format("{}: '{}' is in [{}], and the FMU has it in [{}]; write the values in the FMU's unit",
                      file.name(), title.name, title.unit, variable->unit.empty() ? "-" : variable->unit));
    }
    columns.push_back({variable, instance + "." + variable->name, nullptr});
    wanted.push_back({i, &model, variable});
  }
  if (columns.empty()) {
    throw InputError(
        ErrorCode::missing_key,
        fmt::format("{}: the file has a column for the time only; add columns named after variables of the FMU",
                    file.name()));
  }
  auto signals = file.read(wanted);
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i].signal = std::move(signals[i]);
  return columns;
}

/// The values of a run at its communication points.
class Results {
 public:
  Results(Run& run, const std::vector<Expected>& columns) : run_(&run) {
    for (const auto& column : columns) {
      if (!is_number(column.variable->type)) texts_of_.push_back(column.variable);
    }
  }

  void fly() {
    run_->start();
    do {
      times_ns_.push_back(run_->time_ns());
      read_texts();
    } while (run_->step());
  }

  const std::vector<std::int64_t>& times_ns() const { return times_ns_; }
  /// Returns the index of the last communication point that is not after this time.
  std::size_t row_at(std::int64_t time_ns) const {
    const auto after = std::ranges::upper_bound(times_ns_, time_ns);
    return static_cast<std::size_t>(after - times_ns_.begin()) - 1;
  }

  double number(const Expected& column, std::int64_t time_ns) const {
    const auto* series = run_->memory().find(column.recorded);
    MEBOTS_ASSERT(series != nullptr && series->values.size() == times_ns_.size());
    const auto row = row_at(time_ns);
    const double value = series->values[row];
    if (times_ns_[row] == time_ns || row + 1 == times_ns_.size() || !column.signal->linear()) return value;
    const double part =
        static_cast<double>(time_ns - times_ns_[row]) / static_cast<double>(times_ns_[row + 1] - times_ns_[row]);
    return value + part * (series->values[row + 1] - value);
  }

  const std::string& text(const Expected& column, std::int64_t time_ns) const {
    const auto place = std::ranges::find(texts_of_, column.variable) - texts_of_.begin();
    return texts_[row_at(time_ns)][static_cast<std::size_t>(place)];
  }

 private:
  void read_texts() {
    if (texts_of_.empty()) return;
    auto& texts = texts_.emplace_back();
    run_->call(0, "test", [&](Slave& slave) {
      for (const auto* variable : texts_of_)
        texts.push_back(std::get<std::string>(get_value(slave, kind_of(variable->type), variable->value_reference)));
    });
  }

  Run* run_;
  std::vector<const modeldesc::Variable*> texts_of_;  // Strings and Binaries
  std::vector<std::int64_t> times_ns_;
  std::vector<std::vector<std::string>> texts_;  // indexed by communication point
};

/// Compares a value with its expected value. Returns nullopt if the difference is within the tolerance.
std::optional<Divergence> compared(const Expected& column, const Signal::Value& expected, const Results& results,
                                   std::int64_t time_ns, const Tolerance& tolerance) {
  Divergence divergence;
  divergence.variable = column.variable->name;
  if (const auto* text = std::get_if<std::string>(&expected)) {
    if (results.text(column, time_ns) == *text) return std::nullopt;
    const auto shown = [&](const std::string& one) {
      return fmt::format("'{}'", value_text(column.variable->type, one));
    };
    divergence.expected = shown(*text);
    divergence.got = shown(results.text(column, time_ns));
    return divergence;
  }
  const bool real = std::holds_alternative<double>(expected);
  const double wanted = real ? std::get<double>(expected) : std::get<std::int64_t>(expected);
  const double got = results.number(column, time_ns);
  divergence.tolerance = real ? tolerance.of(wanted) : 0;
  if (std::abs(got - wanted) <= divergence.tolerance) return std::nullopt;
  divergence.expected = fmt::format("{}", wanted);
  divergence.got = fmt::format("{}", got);
  divergence.difference = got - wanted;
  return divergence;
}

/// Returns the first divergence of a variable, or nullopt.
std::optional<Divergence> first_divergence(const Expected& column, const Results& results, const Tolerance& tolerance) {
  const auto& times = column.signal->times();
  std::size_t near = 0;
  for (std::size_t row = 0; row < times.size(); ++row) {
    const SignalTime time{times.ns(row), times.s(row)};
    if (time.ns < results.times_ns().front()) continue;
    auto divergence = compared(column, column.signal->at(time, SignalSide::after, near), results, time.ns, tolerance);
    if (!divergence) continue;
    std::size_t before = 0;
    if (!compared(column, column.signal->at(time, SignalSide::before, before), results, time.ns, tolerance)) continue;
    divergence->time_s = time.s;
    return divergence;
  }
  return std::nullopt;
}

void compare(const CaseDescription& description, const std::vector<Expected>& columns, const Results& results,
             CaseResult& result) {
  const auto& times = columns.front().signal->times();
  const auto last = times.size() - 1;
  if (times.ns(last) < results.times_ns().front()) {
    throw InputError(ErrorCode::invalid_value,
                     fmt::format("the last expected row at {} s is before the start of the run at {} s", times.s(last),
                                 to_seconds(results.times_ns().front())));
  }
  if (times.ns(last) > results.times_ns().back()) {
    throw InputError(ErrorCode::invalid_value,
                     fmt::format("the run ended at {} s, before the last expected row at {} s",
                                 to_seconds(results.times_ns().back()), times.s(last)));
  }
  std::vector<Divergence> divergences;
  for (const auto& column : columns) {
    auto found = first_divergence(column, results, description.tolerance_of(column.variable->name));
    if (found) divergences.push_back(std::move(*found));
  }
  result.rows = times.size();
  result.variables = columns.size();
  if (divergences.empty()) return;
  result.verdict = Verdict::failed;
  std::ranges::stable_sort(divergences, {}, &Divergence::time_s);
  result.first = divergences.front();
  for (std::size_t i = 1; i < divergences.size(); ++i) result.others.push_back(divergences[i].variable);
}

RunOptions options_of(const CaseDescription& description, const CaseOptions& options) {
  RunOptions run;
  run.settings = description.parameters;
  run.inputs = description.inputs;
  run.step_s = description.step;
  run.out = options.folder;
  run.isolate = options.isolate;
  return run;
}

/// Returns the stop time of the case. If the case has none, returns the first communication point at or after the last
/// expected row.
std::int64_t stop_time_of(const CaseDescription& description, const SystemDescription& system,
                          const SignalTimes& expected) {
  if (description.stop_time_ns) return *description.stop_time_ns;
  const auto grid = system.grid();
  const auto last_ns = std::max(expected.ns(expected.size() - 1), system.start_time_ns);
  const auto k = grid.point_at(last_ns);
  return grid.time_ns(std::max<std::int64_t>(grid.time_ns(k) == last_ns ? k : k + 1, 1));
}

void run_and_compare(const std::filesystem::path& fmu, const CaseDescription& description, const CaseOptions& options,
                     CaseResult& result) {
  Run run(fmu, options_of(description, options));
  const auto& instance = run.system().instances.front();
  const auto fmu_file = run.library()->open(instance.fmu_path);
  const auto model_of_sizes = fmu_file->model(structural_values(instance, fmu_file->description()));
  const auto& model = *model_of_sizes;
  const auto columns = read_expected(description.expected, model, instance.name);
  run.set_stop_time(stop_time_of(description, run.system(), columns.front().signal->times()), "stop_time");
  std::vector<std::string> recorded;
  for (const auto& column : columns) {
    if (is_number(column.variable->type)) recorded.push_back(column.recorded);
  }
  run.record(recorded);
  Results results(run, columns);
  results.fly();
  compare(description, columns, results, result);
}

}  // namespace

std::string Divergence::text() const {
  auto text = fmt::format("at {} s {} is {}, expected {}", time_s, variable, got, expected);
  if (difference) text += fmt::format(" (difference {:.6g}, tolerance {:.6g})", *difference, tolerance);
  return text;
}

std::string CaseResult::text() const {
  if (verdict == Verdict::error) return error;
  if (!first) return fmt::format("{} rows of {} variables", rows, variables);
  auto text = first->text();
  if (others.empty()) return text;
  constexpr std::size_t kMostNamed = 5;
  const auto named = std::span(others).first(std::min(others.size(), kMostNamed));
  return fmt::format("{}; {} more diverge: {}{}", text, others.size(), fmt::join(named, ", "),
                     others.size() > kMostNamed ? ", ..." : "");
}

CaseResult run_case(const std::filesystem::path& fmu, const CaseDescription& description, const CaseOptions& options) {
  CaseResult result;
  result.name = description.name;
  const auto start = std::chrono::steady_clock::now();
  try {
    run_and_compare(fmu, description, options, result);
  } catch (const Error& error) {
    result.verdict = Verdict::error;
    result.error = error.what();
  }
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

std::string_view name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::passed:
      return "passed";
    case Verdict::failed:
      return "failed";
    case Verdict::error:
      break;
  }
  return "error";
}

std::filesystem::path fmu_of(const CaseFile& file) {
  if (!file.fmu.empty()) return find_fmu(file.fmu, file.folder);
  throw InputError(ErrorCode::missing_key,
                   fmt::format("the cases in {} name no FMU; write \"fmu\" there, or give the FMU with the cases",
                               file.folder.string()));
}

std::string run_case_as_json(const std::filesystem::path& file, const std::string& name,
                             const std::optional<std::filesystem::path>& fmu, bool isolate) {
  const auto cases = read_cases(file);
  const auto found = std::ranges::find(cases.cases, name, &CaseDescription::name);
  if (found == cases.cases.end())
    throw InputError(ErrorCode::unknown_name, fmt::format("{}: there is no case '{}'", file.string(), name));
  const auto result = run_case(fmu ? *fmu : fmu_of(cases), *found, {.isolate = isolate});
  return nlohmann::json({{"verdict", name_of(result.verdict)}, {"text", result.text()}}).dump();
}

}  // namespace mebots::master::cases
