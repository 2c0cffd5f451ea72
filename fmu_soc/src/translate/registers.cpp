// SPDX-License-Identifier: Apache-2.0
#include "translate/registers.hpp"

#include <algorithm>
#include <numeric>

namespace mebots::soc::translate {
namespace {

/// Whether translated code can do this instruction with the register `reg` of it in a vector register: it moves there
/// and from there only as a whole (Emitter::copy, value, finish, set).
bool can_be_vector(const Instruction& at, std::uint8_t reg) {
  const bool is_target = reg == at.rd;
  const bool is_first = reg == at.rs1;
  const bool is_second = reg == at.rs2;
  const auto& traits = traits_of(at.op);
  switch (traits.kind) {
    case OpKind::dot_product:
    case OpKind::simd:
    case OpKind::simd_compare:
    case OpKind::simd_shift:
    case OpKind::simd_parts:
    case OpKind::shifted_sum:
      return true;
    case OpKind::load:
      return !is_first && !(has_step_register(traits.mode) && is_second);
    case OpKind::store:
      return !is_first && !(has_step_register(traits.mode) && reg == at.imm);
    case OpKind::other:
      break;
    default:
      return false;
  }
  switch (at.op) {
    case Op::lui:
    case Op::auipc:
    case Op::slli:
    case Op::srli:
    case Op::srai:
    case Op::andi:
    case Op::ori:
    case Op::xori:
    case Op::p_clip:
    case Op::p_clipu:
      return true;
    case Op::addi:
      return !(is_target && is_first);
    case Op::add:
      return !is_target || (at.rd != at.rs1 && at.rd != at.rs2);
    case Op::sub:
    case Op::mul:
    case Op::xor_:
    case Op::or_:
    case Op::and_:
      return !is_second;
    default:
      return false;
  }
}

/// Weighted uses of each register.
struct Uses {
  std::array<std::uint64_t, 33> all{};
  std::array<std::uint64_t, 33> in_dot_products{};
  std::array<bool, 33> not_vector{};

  void add(const Instruction& at, std::uint8_t reg, std::uint32_t weight) {
    all[reg] += weight;
    if (is_dot_product(at.op)) in_dot_products[reg] += weight;
    not_vector[reg] = not_vector[reg] || !can_be_vector(at, reg);
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
      counted.add(*at, at->rs1, node.weight);
      if (!is_hardware_loop(at->op)) counted.add(*at, at->rs2, node.weight);
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
    if (uses[reg] == 0 || counted.not_vector[reg] || 2 * dots[reg] < uses[reg]) continue;
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
