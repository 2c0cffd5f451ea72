// SPDX-License-Identifier: Apache-2.0
#include "record/scenario.hpp"

#include "base/time.hpp"

#include <algorithm>
#include <span>

namespace mebots::master {

Scenario::Scenario(const ResolvedSystem& system) : schedule_(system), triggers_(schedule_.overrides().size()) {}

void Scenario::watch(const ResolvedSystem& system, Ensemble& ensemble) {
  for (std::size_t i = 0; i < triggers_.size(); ++i) {
    const auto& when = schedule_.overrides()[i].description->when;
    if (when) triggers_[i].condition.emplace(system, ensemble, *when);
  }
}

std::optional<std::string> Scenario::reached(const Point& point) {
  for (std::size_t i = 0; i < triggers_.size(); ++i) {
    auto& trigger = triggers_[i];
    const auto& description = *schedule_.overrides()[i].description;
    if (!trigger.condition || schedule_.begin_of(i) || point.time_ns < description.from_ns) continue;
    if (!trigger.condition->holds()) {
      trigger.holds_since_ns.reset();
      continue;
    }
    if (!trigger.holds_since_ns) trigger.holds_since_ns = point.time_ns;
    if (schedule_.grid().has_passed(*trigger.holds_since_ns, point.time_ns, description.when->for_ns)) {
      schedule_.start(i, point.time_ns);
    }
  }
  return std::nullopt;
}

void Scenario::visit(state::Visitor& v) {
  v("schedule", schedule_);
  v("triggers", std::span(triggers_));
}

nlohmann::ordered_json Scenario::report(const ResolvedSystem& system, std::int64_t end_ns) const {
  auto json = nlohmann::ordered_json::array();
  for (auto i = schedule_.inputs(); i < schedule_.overrides().size(); ++i) {
    const auto& description = *schedule_.overrides()[i].description;
    nlohmann::ordered_json entry = {{"variable", system.text(schedule_.overrides()[i].variable)},
                                    {"action", action_text(description)}};
    if (!description.text.empty()) entry["text"] = description.text;
    const auto start = schedule_.begin_of(i);
    const bool applied = start && *start <= end_ns;
    entry["applied"] = applied;
    if (applied) {
      auto until_ns = end_ns;
      if (description.until_ns) until_ns = std::min(until_ns, *description.until_ns);
      if (description.duration_ns) until_ns = std::min(until_ns, *start + *description.duration_ns);
      entry["from"] = to_seconds(*start);
      entry["until"] = to_seconds(until_ns);
    }
    json.push_back(std::move(entry));
  }
  return json;
}

}  // namespace mebots::master
