// SPDX-License-Identifier: Apache-2.0
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
    {"signal", OverrideAction::signal},
};

void read_action(Object& object, OverrideDescription& override) {
  int actions = 0;
  for (const auto& action : kActions) {
    object.visit_if(action.key, [&](const Node& value) {
      ++actions;
      override.action = action.action;
      if (action.action == OverrideAction::set) {
        override.value = written_value(value);
      } else if (action.action == OverrideAction::signal) {
        override.column = value.readable_text();
      } else if (action.action == OverrideAction::freeze) {
        if (!value.flag())
          value.fail(ErrorCode::invalid_value,
                     "'freeze' must be true; remove the entry if the variable must not be overridden");
      } else {
        override.number = value.number();
        if (action.action == OverrideAction::noise && override.number < 0) {
          value.fail(ErrorCode::value_out_of_range, "a standard deviation must not be negative");
        }
      }
    });
  }
  if (actions != 1) {
    object.node().complain(
        ErrorCode::invalid_value,
        "an entry needs exactly one of 'set', 'offset', 'scale', 'freeze', 'noise', 'ramp' and 'signal'");
  }
}

/// Reads a key that is required for `action` and a mistake for other actions.
template <typename T, typename Reader>
void read_with(Object& object, std::string_view key, T& into, bool wanted, std::string_view action,
               const Reader& reader) {
  if (wanted) {
    object.read(key, into, reader);
    return;
  }
  object.visit_if(key, [&](const Node& node) {
    node.fail(ErrorCode::invalid_value, fmt::format("this key is allowed only together with '{}'", action));
  });
}

void read_times(Object& object, const SystemDescription& system, OverrideDescription& override) {
  override.from_ns = std::min<std::int64_t>(0, system.start_time_ns);
  object.read_if("from", override.from_ns, &time_ns);
  object.read_if("until", override.until_ns, [&](const Node& node) {
    const auto until_ns = time_ns(node);
    if (until_ns <= override.from_ns) node.fail(ErrorCode::invalid_value, "this time must be after 'from'");
    return until_ns;
  });
  object.read_if("when", override.when, [&](const Node& node) { return read_lasting_condition(node, system); });
  object.read_if("duration", override.duration_ns, [](const Node& node) {
    const auto duration = duration_ns(node);
    if (duration == 0) node.fail(ErrorCode::value_out_of_range, "a duration must be longer than 0 s");
    return duration;
  });
}

void read_file_of_signal(Object& object, const std::filesystem::path& folder, OverrideDescription& override) {
  const bool signal = override.action == OverrideAction::signal;
  if (signal) {
    override.file = read_signal_file(object, folder);
    return;
  }
  for (const std::string_view key : kSignalFileKeys) {
    bool unused = false;
    read_with(object, key, unused, false, "signal", &Node::flag);
  }
}

OverrideDescription read_override(const Node& node, const SystemDescription& system,
                                  const std::filesystem::path& folder) {
  Object object(node);
  OverrideDescription override;
  override.place = node.place();
  object.read_if("text", override.text, &Node::text);
  object.read("variable", override.variable, variable_of(system));
  read_action(object, override);
  object.read_if("unit", override.unit, &Node::readable_text);
  // A seed is required, because noise without a seed is not reproducible.
  read_with(object, "seed", override.seed, override.action == OverrideAction::noise, "noise", &Node::natural_number);
  read_with(object, "over", override.over_ns, override.action == OverrideAction::ramp, "ramp", &duration_ns);
  read_file_of_signal(object, folder, override);
  read_times(object, system, override);
  object.finish();
  return override;
}

}  // namespace

namespace {

void append_overrides(const Node& node, SystemDescription& system, const std::filesystem::path& folder) {
  auto overrides = data::list_of([&](const Node& element) { return read_override(element, system, folder); })(node);
  for (auto& override : overrides) system.scenario.push_back(std::move(override));
}

}  // namespace

void read_scenario(const Node& node, SystemDescription& system) {
  append_overrides(node, system, system.file.parent_path());
}

void read_scenario_file(const Node& root, SystemDescription& system, const std::filesystem::path& folder) {
  Object object(root);
  object.comment("$schema");
  object.comment("text");
  object.visit("scenario", [&](const Node& node) { append_overrides(node, system, folder); });
  object.finish();
}

}  // namespace mebots::master::config
