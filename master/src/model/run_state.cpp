// SPDX-License-Identifier: Apache-2.0
#include "mebots/run_state.hpp"

#include <array>
#include <cstddef>

namespace mebots {
namespace {

// In the order of the enumerations.
constexpr std::array<std::string_view, 5> kStates = {"open", "ready", "running", "ended", "failed"};
constexpr std::array<std::string_view, 6> kReasons = {"stop_time",   "stop_condition", "terminated",
                                                      "interrupted", "closed",         "failed"};
static_assert(kStates.size() == static_cast<std::size_t>(RunState::failed) + 1);
static_assert(kReasons.size() == static_cast<std::size_t>(EndReason::failed) + 1);

}  // namespace

std::string_view name_of(RunState state) {
  return kStates[static_cast<std::size_t>(state)];
}

std::string_view name_of(EndReason reason) {
  return kReasons[static_cast<std::size_t>(reason)];
}

}  // namespace mebots
