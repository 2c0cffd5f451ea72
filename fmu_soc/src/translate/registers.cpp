// SPDX-License-Identifier: Apache-2.0
#include "translate/registers.hpp"

#include <algorithm>
#include <numeric>

namespace mebots::soc::translate {
namespace {

/// What a register costs by weight, in moves to where an instruction wants it and back.
struct Uses {
  std::array<std::uint64_t, 33> all{};
  std::array<std::uint64_t, 33> in_dot_products{};

  void add(const Instruction& at, std::uint8_t reg, std::uint32_t weight) {
    all[reg] += weight;
    if (is_dot_product(at.op)) in_dot_products[reg] += weight;
  }
};

}  // namespace

Registers allocate(const Region& region) {
  Registers registers;
  registers.host.fill(Registers::kInMemory);
  registers.vector.fill(Registers::kInMemory);
  Uses counted;
  for (const auto& node : region.nodes) {
    for (const auto* at = node.first; !is_block_end(at->op); ++at) {
      counted.add(*at, at->rd, node.weight);
      if (reads_rd(at->op)) counted.add(*at, at->rd, node.weight);
      counted.add(*at, at->rs1, node.weight);
      if (traits_of(at->op).reads_rs2) counted.add(*at, at->rs2, node.weight);
      if (is_store(at->op) && has_step_register(traits_of(at->op).mode)) {
        counted.add(*at, static_cast<std::uint8_t>(at->imm), node.weight);  // offset or increment
      }
      registers.written[at->rd] = true;
      if (is_post_increment(at->op)) registers.written[at->rs1] = true;
    }
  }
  auto& uses = counted.all;
  uses[0] = 0;   // a constant
  uses[32] = 0;  // nobody reads it
  std::array<std::uint8_t, 33> order{};
  std::iota(order.begin(), order.end(), std::uint8_t{0});
  const auto& dots = counted.in_dot_products;
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return dots[a] > dots[b]; });
  for (const auto reg : order) {
    if (registers.vector_count == kVectorRegisters || dots[reg] == 0) break;
    if (uses[reg] == 0 || 2 * dots[reg] < uses[reg]) continue;
    registers.vector[reg] = static_cast<std::int8_t>(registers.vector_count);
    registers.vector_guest[registers.vector_count++] = reg;
    uses[reg] = 0;
  }
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return uses[a] > uses[b]; });
  for (const auto reg : order) {
    if (registers.count == kHostRegisters || uses[reg] == 0) break;
    registers.host[reg] = static_cast<std::int8_t>(registers.count);
    registers.guest[registers.count++] = reg;
  }
  return registers;
}

}  // namespace mebots::soc::translate
