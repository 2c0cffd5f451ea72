// SPDX-License-Identifier: Apache-2.0
#include "translate/registers.hpp"

#include <algorithm>
#include <numeric>

namespace mebots::soc::translate {
namespace {

/// Of a store: post-increment by an immediate.
bool is_immediate_step(Op op) {
  return op >= Op::p_sb_post && op <= Op::p_sw_post;
}

}  // namespace

Registers allocate(const Region& region) {
  Registers registers;
  registers.host.fill(Registers::kInMemory);
  std::array<std::uint64_t, 33> uses{};
  for (const auto& node : region.nodes) {
    for (const auto* at = node.first; !is_block_end(at->op); ++at) {
      uses[at->rd] += node.weight;
      uses[at->rs1] += node.weight;
      if (!is_hardware_loop(at->op)) uses[at->rs2] += node.weight;
      if (is_store(at->op) && at->op > Op::sw && !is_immediate_step(at->op)) {
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
