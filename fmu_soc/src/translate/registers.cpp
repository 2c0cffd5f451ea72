// SPDX-License-Identifier: Apache-2.0
#include "translate/registers.hpp"

#include <algorithm>
#include <numeric>

namespace mebots::soc::translate {

Registers allocate(const Region& region) {
  Registers registers;
  registers.host.fill(Registers::kInMemory);
  std::array<std::uint64_t, 33> uses{};
  for (const auto& node : region.nodes) {
    for (const auto* at = node.first; !is_block_end(at->op); ++at) {
      for (const auto reg : {at->rd, at->rs1, at->rs2}) uses[reg] += node.weight;
      registers.written[at->rd] = true;
    }
  }
  uses[0] = 0;   // a constant
  uses[32] = 0;  // nobody reads it
  std::array<std::uint8_t, 33> order{};
  std::iota(order.begin(), order.end(), std::uint8_t{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return uses[a] > uses[b]; });
  for (const auto reg : order) {
    if (registers.count == kHostRegisters || uses[reg] == 0) break;
    registers.host[reg] = static_cast<std::int8_t>(registers.count);
    registers.guest[registers.count++] = reg;
  }
  return registers;
}

}  // namespace mebots::soc::translate
