// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// Finds groups of instances that step together.
class InstanceGroups {
 public:
  explicit InstanceGroups(std::size_t instances);

  void join(std::size_t one, std::size_t other);
  /// Returns the groups of all instances for which `belongs` is true. Sorts the groups by their first members, and the
  /// members in ascending order.
  std::vector<std::vector<std::size_t>> of(const std::function<bool(std::size_t)>& belongs) const;

 private:
  std::size_t leader(std::size_t instance) const;

  std::vector<std::size_t> leaders_;  // for each instance: an earlier instance of its group, or the instance itself
};

/// Throws InputError about the key `key` of an instance in the config. `what` is the text of the error.
[[noreturn]] void refuse_key(const ResolvedSystem& system, std::size_t instance, std::string_view key,
                             const std::string& what);

/// The words for a group and its members in messages.
struct GroupWords {
  std::string_view member;  ///< such as "is of model exchange"
  std::string_view group;   ///< such as "continuous system"
};

/// Throws InputError if the members of a group cannot step together: if their steps differ, if a member repeats
/// discarded steps in shorter parts, or if one of several members may fail while the run continues.
void check_members(const ResolvedSystem& system, const std::vector<std::size_t>& members, const GroupWords& words);

}  // namespace mebots::master
