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
      uses[at->rd] += node.weight;
      uses[at->rs1] += node.weight;
      if (!is_hardware_loop(at->op)) uses[at->rs2] += node.weight;
      if (is_store(at->op) && has_step_register(traits_of(at->op).mode)) {
        uses[static_cast<std::size_t>(at->imm)] += node.weight;  // offset or increment
      }
      registers.written[at->rd] = true;
      if (is_post_increment(at->op)) registers.written[at->rs1] = true;
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
