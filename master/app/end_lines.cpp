// SPDX-License-Identifier: Apache-2.0
#include "end_lines.hpp"

#include "base/time.hpp"
#include "message/message_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <utility>

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

Json member_of(const Json& object, const std::string& label) {
  return object.is_object() && object.contains(label) ? object.at(label) : Json();
}

std::string interval_text(const Json& interval) {
  return fmt::format("{} to {}", value_text(interval[0]), value_text(interval[1]));
}

std::string unit_text(const Json& unit) {
  return unit.is_string() && unit != "1" ? " " + unit.get<std::string>() : "";
}

/// Appends each value with its interval. `intervals` has the same labels as `values`.
void append_values(const Json& values, const Json& units, const Json& intervals, const std::string& prefix,
                   std::vector<std::string>& lines) {
  for (const auto& [label, value] : values.items()) {
    const auto unit = member_of(units, label);
    const auto interval = member_of(intervals, label);
    if (value.is_object()) {
      append_values(value, unit, interval, prefix + label + ".", lines);
      continue;
    }
    lines.push_back(fmt::format("  {:<24} {}{}{}", prefix + label, value_text(value), unit_text(unit),
                                interval.is_array() ? fmt::format(" ({})", interval_text(interval)) : ""));
  }
}

/// True if `value` is a group: an object with statistics and the members' values under `each`.
bool is_group(const Json& value) {
  return value.is_object() && member_of(value, "each").is_object() &&
         (value.contains("least") || value.contains("count") || value.contains("counts"));
}

std::string short_text(const Json& value) {
  return value.is_number_float() ? fmt::format("{:.4g}", value.get<double>()) : value_text(value);
}

/// Returns the values of a group as text, such as "0.21 (7) to 0.93 (2), mean 0.5" or "14 of 16 (not 3, 9)".
std::string group_text(const Json& group, const Json& units) {
  if (group.contains("least") && short_text(group["least"]) == short_text(group["most"])) {
    return fmt::format("{}{} each", short_text(group["mean"]), unit_text(member_of(units, "mean")));
  }
  if (group.contains("least")) {
    return fmt::format("{} ({}) to {} ({}), mean {}{}", short_text(group["least"]), value_text(group["least_of"]),
                       short_text(group["most"]), value_text(group["most_of"]), short_text(group["mean"]),
                       unit_text(member_of(units, "mean")));
  }
  std::vector<std::string> parts;
  if (group.contains("counts")) {
    for (const auto& [item, count] : group["counts"].items()) parts.push_back(fmt::format("{} {}", count.dump(), item));
    return fmt::format("{}", fmt::join(parts, ", "));
  }
  for (const auto& [name, value] : group["each"].items()) {
    if (value == false) parts.push_back(name);
  }
  const bool is_split = !parts.empty() && parts.size() < group["each"].size();
  return fmt::format("{} of {}{}", group["count"].dump(), group["of"].dump(),
                     is_split ? fmt::format(" (not {})", fmt::join(parts, ", ")) : "");
}

constexpr std::size_t kMostLines = 10;
constexpr std::size_t kWidest = 110;
constexpr auto kCut = ", ...";

/// Builds a line of values. Truncates the line if it becomes too wide.
class ValueLine {
 public:
  explicit ValueLine(std::string head) : text_(std::move(head)) {}

  void add(const std::string& label, const Json& value, const Json& unit, const Json& interval) {
    const auto range = interval.is_array() ? fmt::format(" ({})", interval_text(interval)) : "";
    add(fmt::format("{} {}{}{}", label, short_text(value), unit_text(unit), range));
  }
  void add(const std::string& text) {
    if (cut_) return;
    const auto piece = fmt::format("{}{}", empty_ ? "" : ", ", text);
    if (!empty_ && text_.size() + piece.size() > kWidest) {
      cut_ = true;
      text_ += kCut;
      return;
    }
    empty_ = false;
    text_ += piece;
  }
  void add_all(const Json& values, const Json& units, const Json& intervals, const std::string& prefix = "") {
    for (const auto& [label, value] : values.items()) {
      const auto unit = member_of(units, label);
      const auto interval = member_of(intervals, label);
      if (is_group(value)) {
        add(fmt::format("{}{} {}", prefix, label, group_text(value, unit)));
      } else if (value.is_object()) {
        add_all(value, unit, interval, prefix + label + ".");
      } else {
        add(prefix + label, value, unit, interval);
      }
    }
  }

  bool is_full() const { return cut_; }
  bool is_empty() const { return empty_; }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  bool empty_ = true;
  bool cut_ = false;
};

/// Appends a line with all single values, and then a line for each group or other object. If some values do not fit,
/// the last line names the option that prints all.
void append_shared(const Json& values, const Json& units, const Json& intervals, std::vector<std::string>& lines) {
  std::vector<ValueLine> own;
  bool is_cut = false;
  ValueLine alone("  ");
  for (const auto& [label, value] : values.items()) {
    if (value.is_object()) continue;
    alone.add(label, value, member_of(units, label), member_of(intervals, label));
  }
  if (!alone.is_empty()) own.push_back(alone);
  for (const auto& [label, value] : values.items()) {
    if (!value.is_object()) continue;
    auto& line = own.emplace_back(fmt::format("  {}: ", label));
    if (is_group(value)) {
      line.add(group_text(value, member_of(units, label)));
    } else {
      line.add_all(value, member_of(units, label), member_of(intervals, label));
    }
  }
  const auto most = kMostLines - std::min(kMostLines, lines.size() + 1);
  for (const auto& line : own) is_cut |= line.is_full();
  is_cut |= own.size() > most;
  if (own.size() > most) own.resize(most, ValueLine(""));
  for (const auto& line : own) lines.push_back(line.text());
  if (is_cut) lines.back() += "  (all values: --verbose)";
}

/// Returns a text such as "1000 steps of 0.001 s". If the step varies, returns its limits.
std::string steps_text(const master::SystemDescription& system) {
  if (const auto& control = system.step_control) {
    return fmt::format("steps of {} to {} s", master::time_text(system.length_of(control->min_steps)),
                       master::time_text(system.length_of(control->max_steps)));
  }
  return fmt::format("{} steps of {} s", system.grid().point_at(system.stop_time_ns), master::to_seconds(system.step));
}

/// Returns the outcomes and intervals of the drawn runs as one line.
std::string uncertainty_line(const Json& uncertainty) {
  std::vector<std::string> outcomes;
  for (const auto& [outcome, count] : uncertainty["outcomes"].items())
    outcomes.push_back(fmt::format("{} {}", outcome, count.get<int>()));
  const auto time = member_of(uncertainty["intervals"], "simulated_time");
  return fmt::format("uncertainty: 9 of 10 flights last {} s; the ranges of other values are below ({} draws: {})",
                     time.is_array() ? interval_text(time) : "nothing", uncertainty["flights"].get<int>(),
                     fmt::join(outcomes, ", "));
}

}  // namespace

std::vector<std::string> end_lines(const master::Run& run, bool verbose) {
  const auto& report = run.report();
  std::vector<std::string> lines;
  lines.push_back(fmt::format("outcome: {} ({})", run.outcome(), report.end_text));
  if (run.files() == nullptr || !run.files()->kept()) return lines;  // the start time was not reached
  lines.push_back(fmt::format("simulated {} s in {} of stepping, {:.3g} x real time",
                              master::to_seconds(report.simulated_ns), short_duration(report.wall.stepping_s),
                              report.real_time_factor()));
  const auto uncertainty = member_of(run.summary(), "uncertainty");
  if (!uncertainty.is_null()) lines.push_back(uncertainty_line(uncertainty));
  const auto values = run.values().values();
  const auto units = run.values().units();
  const auto intervals = member_of(uncertainty, "intervals");
  if (verbose) {
    append_values(values, units, intervals, "", lines);
  } else {
    append_shared(values, units, intervals, lines);
  }
  lines.push_back(fmt::format("results: {} ({} rows, {} columns), {}", run.files()->rows_file().string(), report.rows,
                              run.columns(), (run.files()->folder() / "summary.json").string()));
  return lines;
}

std::vector<std::string> start_lines(const master::Run& run) {
  const auto& system = run.system();
  const auto grid = system.grid();
  std::vector<std::string> names;
  for (const auto& instance : system.instances) names.push_back(instance.name);
  return {fmt::format("{}: {} instances ({}), {} connections", system.name, names.size(), fmt::join(names, ", "),
                      run.resolved().connections.size()),
          fmt::format("to {} s in {}; a row has {} columns", grid.time_s(system.stop_time_ns), steps_text(system),
                      run.columns()),
          "every check passed, and t = 0 was reached; nothing was written"};
}

}  // namespace mebots::app
