// SPDX-License-Identifier: Apache-2.0
#include "run_texts.hpp"

#include "base/time.hpp"
#include "mebots/input_error.hpp"
#include "mebots/nearest_names.hpp"
#include "message/plain_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace mebots::app {
namespace {

using Json = nlohmann::ordered_json;

std::string short_duration(double seconds) {
  return seconds < 1 ? fmt::format("{:.3g} ms", seconds * 1e3) : fmt::format("{:.3g} s", seconds);
}

std::string value_text(const Json& value) {
  if (value.is_string()) return master::one_line(master::valid_utf8(value.get<std::string>()));
  if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
  return value.dump();
}

void append_values(const Json& values, const Json& units, const std::string& prefix, std::vector<std::string>& lines) {
  for (const auto& [label, value] : values.items()) {
    const auto unit = units.is_object() && units.contains(label) ? units.at(label) : Json();
    if (value.is_object()) {
      append_values(value, unit, prefix + label + ".", lines);
      continue;
    }
    const bool shown_unit = unit.is_string() && unit != "1";
    lines.push_back(fmt::format("  {:<24} {}{}", prefix + label, value_text(value),
                                shown_unit ? " " + unit.get<std::string>() : ""));
  }
}

}  // namespace

std::vector<std::string> end_lines(const master::Run& run) {
  const auto& report = run.report();
  std::vector<std::string> lines;
  lines.push_back(fmt::format("outcome: {} ({})", run.outcome(), report.end_text));
  if (run.files() == nullptr || !run.files()->kept()) return lines;  // it never came to t = 0
  lines.push_back(fmt::format("simulated {} s in {} of stepping, {:.3g} x real time",
                              master::to_seconds(report.simulated_ns), short_duration(report.wall.stepping_s),
                              report.real_time_factor()));
  append_values(run.values().values(), run.values().units(), "", lines);
  lines.push_back(fmt::format("results: {} ({} rows, {} columns), {}", run.files()->rows_file().string(), report.rows,
                              run.columns(), (run.files()->folder() / "summary.json").string()));
  return lines;
}

std::string why_unexpected(const master::Run& run, const std::vector<std::string>& expected) {
  const auto outcome = run.outcome();
  if (!run.report().faults.empty()) return fmt::format("after the end: {}", run.report().faults.front());
  if (expected.empty() || std::ranges::find(expected, outcome) != expected.end()) return "";
  return fmt::format("the outcome is '{}', and {} was expected", outcome, fmt::join(expected, " or "));
}

void check_expected(const master::SystemDescription& system, const std::vector<std::string>& expected) {
  std::vector<std::string> known = {"completed", "interrupted", "failed"};
  for (const auto& outcome : system.outcomes) known.push_back(outcome.outcome);
  for (const auto& wanted : expected) {
    if (std::ranges::find(known, wanted) != known.end()) continue;
    throw InputError(ErrorCode::unknown_name, fmt::format("--expect: this run cannot have the outcome '{}'. {}", wanted,
                                                          suggest(wanted, known)));
  }
}

std::string shell_word(std::string_view text) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("/._-+=:,@%").find(c) != std::string_view::npos;
  };
  if (!text.empty() && std::ranges::all_of(text, plain)) return std::string(text);
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? "'\\''" : std::string(1, c);
  return word + "'";
}

}  // namespace mebots::app
