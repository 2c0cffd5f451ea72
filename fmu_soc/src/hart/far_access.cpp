// SPDX-License-Identifier: Apache-2.0
#include "hart/far_access.hpp"

#include <algorithm>

namespace mebots::soc {
namespace {

/// How many cycles translated code may still wait in a block.
std::uint64_t room_behind(const Execution& e, std::uint64_t cycle) {
  if (const auto* shared = e.ram[0].banks; shared != nullptr) return shared->cycles_left(cycle);
  const auto passed = cycle - e.counters.cycles;  // of the run, which began at the first row
  return Banks::kReach - std::min(passed, Banks::kReach);
}

}  // namespace

std::uint64_t wait_for_far(Execution& execution, std::uint64_t cycle, std::uint32_t offset) noexcept {
  const auto& far = execution.ram[1];
  const auto address = far.base + offset;
  const auto arrival = cycle + far.wait_cycles;
  const std::uint64_t wait = far.wait_cycles + far.banks->wait(arrival, address);
  if (wait > room_behind(execution, cycle)) return kNoRoom;
  far.banks->claim(arrival, address);
  ++execution.counters.far_accesses;
  return wait;
}

}  // namespace mebots::soc
