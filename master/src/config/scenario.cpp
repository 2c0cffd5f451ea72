// SPDX-License-Identifier: Apache-2.0
// The section `scenario`.
#include "config/conditions.hpp"
#include "reading.hpp"
#include "sections.hpp"

#include <fmt/format.h>

namespace mebots::master::config {
namespace {

struct Action {
  std::string_view key;
  OverrideAction action;
};

constexpr Action kActions[] = {
    {"set", OverrideAction::set},       {"offset", OverrideAction::offset}, {"scale", OverrideAction::scale},
    {"freeze", OverrideAction::freeze}, {"noise", OverrideAction::noise},   {"ramp", OverrideAction::ramp},
};

void read_action(const JsonNode& node, OverrideDescription& override) {
  int actions = 0;
  for (const auto& [key, action] : kActions) {
    const auto value = node.find(key);
    if (!value) continue;
    ++actions;
    override.action = action;
    if (action == OverrideAction::set) {
      override.value = written_value(*value);
    } else if (action == OverrideAction::freeze) {
      if (!value->boolean()) value->fail("write true, or leave this entry out");
    } else {
      override.number = value->number();
      if (action == OverrideAction::noise && override.number < 0) value->fail("a standard deviation is not negative");
    }
  }
  if (actions != 1) {
    node.fail("an entry needs exactly one of 'set', 'offset', 'scale', 'freeze', 'noise' and 'ramp'");
  }
}

/// A key that only one action knows.
std::optional<JsonNode> only_with(const JsonNode& node, std::string_view key, bool allowed, std::string_view action) {
  auto value = node.find(key);
  if (value && !allowed) value->fail(fmt::format("this belongs to '{}' only", action));
  return value;
}

void read_times(const JsonNode& node, const SystemDescription& system, OverrideDescription& override) {
  if (const auto from = node.find("from")) override.from_ns = duration_ns(*from);
  if (const auto until = node.find("until")) {
    override.until_ns = duration_ns(*until);
    if (*override.until_ns <= override.from_ns) until->fail("this is not after 'from'");
  }
  if (const auto when = node.find("when")) {
    when->expect_keys({"variable", "equals", "above", "below", "for"});
    override.when = read_condition(*when, system);
    if (const auto lasting = when->find("for")) override.when->for_ns = duration_ns(*lasting);
  }
  if (const auto duration = node.find("duration")) {
    override.duration_ns = duration_ns(*duration);
    if (*override.duration_ns == 0) duration->fail("a duration is longer than 0 s");
  }
}

OverrideDescription read_override(const JsonNode& node, const SystemDescription& system) {
  node.expect_keys({"text", "variable", "set", "offset", "scale", "freeze", "noise", "ramp", "unit", "seed", "over",
                    "from", "until", "when", "duration"});
  OverrideDescription override;
  override.place = node.place();
  if (const auto text = node.find("text")) override.text = text->string();
  override.variable = variable_name(node.at("variable"), system);
  read_action(node, override);
  if (const auto unit = node.find("unit")) override.unit = readable_text(*unit);
  const bool noise = override.action == OverrideAction::noise;
  if (const auto seed = only_with(node, "seed", noise, "noise")) {
    if (!seed->value().is_number_unsigned()) seed->fail("a seed is a whole number that is not negative");
    override.seed = seed->value().get<std::uint64_t>();
  } else if (noise) {
    node.at("seed");  // noise without a seed could not be repeated
  }
  const bool ramp = override.action == OverrideAction::ramp;
  if (const auto over = only_with(node, "over", ramp, "ramp")) {
    override.over_ns = duration_ns(*over);
  } else if (ramp) {
    node.at("over");
  }
  read_times(node, system, override);
  return override;
}

}  // namespace

void read_scenario(const JsonNode& node, SystemDescription& system) {
  for (const auto& element : node.elements()) system.scenario.push_back(read_override(element, system));
}

void read_scenario_file(const JsonNode& root, SystemDescription& system) {
  root.expect_keys({"text", "scenario"});
  if (const auto text = root.find("text")) text->string();  // for people only
  read_scenario(root.at("scenario"), system);
}

}  // namespace mebots::master::config
