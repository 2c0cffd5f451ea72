// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// Groups of instances that step together.
class InstanceGroups {
 public:
  explicit InstanceGroups(std::size_t instances);

  void join(std::size_t one, std::size_t other);
  /// Returns the groups of the instances that `belongs` selects, ordered by their first members; the members are in
  /// ascending order.
  std::vector<std::vector<std::size_t>> of(const std::function<bool(std::size_t)>& belongs) const;

 private:
  std::size_t leader(std::size_t instance) const;

  std::vector<std::size_t> leaders_;  // for each instance, an earlier one of its group or itself
};

/// Throws InputError about a key of an instance.
[[noreturn]] void refuse_key(const ResolvedSystem& system, std::size_t instance, std::string_view key,
                             const std::string& what);

/// The words with which messages describe a group and its members.
struct GroupWords {
  std::string_view member;  ///< "is of model exchange"
  std::string_view group;   ///< "continuous system"
};

/// Throws InputError if members run in separate processes, have different steps, discard steps or may fail without
/// ending the run.
void check_members(const ResolvedSystem& system, const std::vector<std::size_t>& members, const GroupWords& words);

}  // namespace mebots::master
