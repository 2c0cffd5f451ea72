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
  /// Returns the groups of those instances for which `belongs` returns true. The groups are sorted by their first
  /// members, and the members are in ascending order.
  std::vector<std::vector<std::size_t>> of(const std::function<bool(std::size_t)>& belongs) const;

 private:
  std::size_t leader(std::size_t instance) const;

  std::vector<std::size_t> leaders_;  // for each instance, an earlier instance of its group, or the instance itself
};

/// Throws InputError about the value of a key of an instance.
[[noreturn]] void refuse_key(const ResolvedSystem& system, std::size_t instance, std::string_view key,
                             const std::string& what);

/// The words by which messages describe a group and its members.
struct GroupWords {
  std::string_view member;  ///< such as "is of model exchange"
  std::string_view group;   ///< such as "continuous system"
};

/// Checks that the members of a group can step together. Throws InputError if members have different steps or divide
/// discarded steps, or if a member of several may fail without ending the run.
void check_members(const ResolvedSystem& system, const std::vector<std::size_t>& members, const GroupWords& words);

}  // namespace mebots::master
