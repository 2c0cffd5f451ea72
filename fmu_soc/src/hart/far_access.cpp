// SPDX-License-Identifier: Apache-2.0
#include "hart/far_access.hpp"

#include "mebots/assert.hpp"

#include <algorithm>

namespace mebots::soc {
namespace {

/// For how many cycles there are banks to be taken. Behind that the interpreter finds all free and takes none, and
/// translated code, which does not look where it is, must not come there.
std::uint64_t room_behind(const Execution& e, std::uint64_t cycle) {
  if (const auto* shared = e.ram[0].banks; shared != nullptr) return shared->cycles_left(cycle);
  MEBOTS_ASSERT(cycle >= e.counters.cycles);
  const auto passed = cycle - e.counters.cycles;  // of the run, which began at the first row
  return Banks::kReach - std::min(passed, Banks::kReach);
}

}  // namespace

std::uint64_t wait_for_far(Execution& execution, std::uint64_t cycle, std::uint32_t offset) noexcept {
  const auto& far = execution.ram[1];
  MEBOTS_ASSERT(far.is_shared() && offset < far.span);
  const auto address = far.base + offset;
  const std::uint64_t wait = far.wait_cycles + far.banks->wait(cycle + far.wait_cycles, address);
  if (wait + Banks::kLongestBlock > room_behind(execution, cycle)) return kNoRoom;  // with the rest of the block
  far.banks->claim(cycle + wait, address);
  ++execution.counters.far_accesses;
  return wait;
}

}  // namespace mebots::soc
