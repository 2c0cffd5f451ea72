// SPDX-License-Identifier: Apache-2.0
#include "resolve/instance_groups.hpp"

#include "base/time.hpp"
#include "mebots/input_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace mebots::master {

InstanceGroups::InstanceGroups(std::size_t instances) : leaders_(instances) {
  std::iota(leaders_.begin(), leaders_.end(), std::size_t{0});
}

std::size_t InstanceGroups::leader(std::size_t instance) const {
  while (leaders_[instance] != instance) instance = leaders_[instance];
  return instance;
}

void InstanceGroups::join(std::size_t one, std::size_t other) {
  const auto [first, second] = std::minmax({leader(one), leader(other)});
  leaders_[second] = first;
}

std::vector<std::vector<std::size_t>> InstanceGroups::of(const std::function<bool(std::size_t)>& belongs) const {
  std::map<std::size_t, std::vector<std::size_t>> by_leader;
  for (std::size_t i = 0; i < leaders_.size(); ++i) {
    if (belongs(i)) by_leader[leader(i)].push_back(i);
  }
  std::vector<std::vector<std::size_t>> groups;
  for (auto& [first, members] : by_leader) groups.push_back(std::move(members));
  return groups;
}

void refuse_key(const ResolvedSystem& system, std::size_t instance, std::string_view key, const std::string& what) {
  throw InputError(ErrorCode::invalid_value,
                   fmt::format("{}/{}: {}", system.instances[instance].description->place, key, what));
}

void check_members(const ResolvedSystem& system, const std::vector<std::size_t>& members, const GroupWords& words) {
  const auto& first = *system.instances[members.front()].description;
  for (const auto member : members) {
    const auto& instance = system.instances[member];
    const auto& description = *instance.description;
    if (description.divide_discarded) {
      refuse_key(system, member, "on_discard",
                 fmt::format("'{}' {}; its steps cannot be divided", description.name, words.member));
    }
    if (description.steps != first.steps) {
      refuse_key(
          system, member, "step",
          fmt::format("'{}' and '{}' are in one {}, so they need the same step, but their steps are {} s and {} s",
                      first.name, description.name, words.group, time_text(system.description->step_of(first)),
                      time_text(system.description->step_of(description))));
    }
    if (instance.isolation.continue_without && members.size() > 1) {
      refuse_key(system, member, "on_failure",
                 fmt::format("'{}' is in a {} with other instances, which cannot continue without it", description.name,
                             words.group));
    }
  }
}

}  // namespace mebots::master
