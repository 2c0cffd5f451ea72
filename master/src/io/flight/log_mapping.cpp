// SPDX-License-Identifier: Apache-2.0
#include "io/flight/airframe_file.hpp"

#include "mebots/data/document.hpp"
#include "mebots/data/object.hpp"
#include "mebots/error.hpp"
#include "mebots/modeldesc/units.hpp"
#include "mebots/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master::flight {
namespace {

using data::Limits;
using data::Node;
using data::Object;

// The signals and their units. World axes: x east, y north, z up. Body axes: x forward, y left, z up
// (docs/architecture.md). A positive `battery.current` discharges the battery. `acceleration` is the specific force.
// `attitude` rotates body axes into world axes.
constexpr LogSignal kSignals[] = {
    {"motor[1].command", "1"},   {"motor[2].command", "1"},   {"motor[3].command", "1"},   {"motor[4].command", "1"},
    {"rotor[1].speed", "rad/s"}, {"rotor[2].speed", "rad/s"}, {"rotor[3].speed", "rad/s"}, {"rotor[4].speed", "rad/s"},
    {"battery.voltage", "V"},    {"battery.current", "A"},    {"position.x", "m"},         {"position.y", "m"},
    {"position.z", "m"},         {"velocity.x", "m/s"},       {"velocity.y", "m/s"},       {"velocity.z", "m/s"},
    {"attitude.qx", "1"},        {"attitude.qy", "1"},        {"attitude.qz", "1"},        {"attitude.qw", "1"},
    {"acceleration.x", "m/s2"},  {"acceleration.y", "m/s2"},  {"acceleration.z", "m/s2"},  {"rate.x", "rad/s"},
    {"rate.y", "rad/s"},         {"rate.z", "rad/s"},
};

/// A unit of logs that is not a product of known units.
struct LogUnit {
  std::string_view name;
  std::string_view unit;
  double factor;
};

constexpr LogUnit kLogUnits[] = {
    {"g0", "m/s2", 9.80665},
    {"1/65535", "1", 1.0 / 65535},
};

const LogSignal& find_signal(const Node& node) {
  const auto name = node.text();
  const auto* const found = std::ranges::find(kSignals, name, &LogSignal::name);
  if (found != std::end(kSignals)) return *found;
  std::vector<std::string> known;
  for (const auto& signal : kSignals) known.emplace_back(signal.name);
  node.fail_unknown("the signal", name, known);
}

/// Reads the name of a unit with the dimension of `unit`.
auto convertible_to(std::string_view unit) {
  return [unit](const Node& node) {
    auto name = node.text();
    try {
      static_cast<void>(log_unit_factor(name, unit));
    } catch (const Error& error) {
      node.fail(error.code(), error.what());
    }
    return name;
  };
}

void check_column(const Node& node, std::set<std::string>& taken) {
  Object column(node);
  std::string_view unit;
  std::string text;
  double scale = 1;
  const bool known = column.read("signal", unit, [&](const Node& member) {
    const auto& signal = find_signal(member);
    if (!taken.insert(std::string(signal.name)).second) {
      member.fail(ErrorCode::duplicate_name, fmt::format("the signal {} already has a column", signal.name));
    }
    return signal.unit;
  });
  column.read("unit", text, [&](const Node& member) { return known ? convertible_to(unit)(member) : member.text(); });
  column.read_if("scale", scale, data::number());
  column.finish();
  if (column.sound() && scale == 0)
    node.at("scale").complain(ErrorCode::invalid_value, "a scale of 0 would make every value 0; use another number");
}

void check_clock(const Node& node) {
  Object clock(node);
  std::string text;
  clock.read("column", text, &Node::readable_text);
  clock.read_if("unit", text, convertible_to("s"));
  clock.finish();
}

void check_time(const Node& node) {
  Object time(node);
  std::string text;
  double period = 0;
  time.read_if("column", text, &Node::readable_text);
  time.read_if("period", period, data::number(Limits::positive()));
  time.read_if("unit", text, convertible_to("s"));
  time.visit_if("reference", &check_clock);
  time.finish();
  if (time.has("column") == time.has("period")) {
    node.complain(ErrorCode::missing_key, "either 'column' or 'period' is needed");
  } else if (time.has("reference") && time.has("period")) {
    node.complain(ErrorCode::invalid_value, "a 'reference' needs a 'column' of times to compare with");
  }
}

void check_mapping(const Node& root) {
  Object mapping(root);
  mapping.comment("$schema");
  mapping.comment("text");
  mapping.visit_if("time", &check_time);
  mapping.visit("columns", [](const Node& node) {
    std::set<std::string> taken;
    const auto members = node.members();
    if (members.empty()) node.fail(ErrorCode::invalid_value, "no column is mapped");
    for (const auto& [name, column] : members) column.attempt([&, &column = column] { check_column(column, taken); });
  });
  mapping.finish();
}

}  // namespace

std::span<const LogSignal> log_signals() {
  return kSignals;
}

double log_unit_factor(std::string_view from, std::string_view to) {
  double factor = 1;
  if (const auto* const own = std::ranges::find(kLogUnits, from, &LogUnit::name); own != std::end(kLogUnits)) {
    factor = own->factor;
    from = own->unit;
  }
  const auto given = modeldesc::parse_unit(from);
  const auto wanted = modeldesc::parse_unit(to);
  if (!modeldesc::same_dimension(given, wanted)) {
    throw Error(ErrorCode::wrong_unit, fmt::format("the unit \"{}\" cannot be converted to \"{}\"", from, to));
  }
  return factor * modeldesc::unit_conversion(given, wanted, true).factor;
}

nlohmann::ordered_json read_log_mapping(const std::filesystem::path& file) {
  const auto text = text_of(file);
  data::Document(text, file.string()).read(&check_mapping);
  return nlohmann::ordered_json::parse(text);
}

}  // namespace mebots::master::flight
