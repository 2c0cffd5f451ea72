// SPDX-License-Identifier: Apache-2.0
#include "hart/look_ahead.hpp"

#include "hart/instruction.hpp"
#include "isa/encoding.hpp"

#include <span>

namespace mebots::soc {
namespace {

/// A compiler puts the two halves of a 64-bit store closer together.
constexpr int kFarthest = 32;

std::optional<std::uint32_t> computed(const Decoded& at, std::uint32_t a, std::uint32_t b) {
  if (at.op == Op::lui) return static_cast<std::uint32_t>(at.imm);
  const auto compute = compute_of(at.op);
  if (compute == nullptr) return std::nullopt;
  return compute(a, at.operand == Operand::immediate ? static_cast<std::uint32_t>(at.imm) : b);
}

std::optional<std::uint32_t> loaded(const Memory& memory, const Decoded& at, std::uint32_t address) {
  const auto& traits = traits_of(at.op);
  if (traits.mode != AddressMode::offset) return std::nullopt;
  std::uint32_t value = 0;
  if (!memory.read(address, {reinterpret_cast<std::uint8_t*>(&value), traits.size})) return std::nullopt;
  const unsigned unused_bits = 32 - 8 * traits.size;
  if (!traits.sign) return value;
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(value << unused_bits) >> unused_bits);
}

}  // namespace

std::optional<std::uint32_t> upcoming_store(const Memory& memory, std::uint32_t pc, std::array<std::uint32_t, 32> x,
                                            std::uint32_t address) {
  for (int i = 0; i < kFarthest; ++i) {
    std::array<std::uint8_t, 4> bytes{};
    if (!memory.read(pc, bytes) && !memory.read(pc, std::span(bytes).first<2>())) return std::nullopt;
    const auto at = decode(bytes[0] | bytes[1] << 8U | bytes[2] << 16U | static_cast<std::uint32_t>(bytes[3]) << 24U,
                           Extension::standard);
    const auto a = x[at.rs1];
    const auto b = x[at.rs2];
    const auto offset = static_cast<std::uint32_t>(at.imm);
    auto next = pc + at.length;
    std::optional<std::uint32_t> result;
    if (is_store(at.op)) {
      const auto target = a + offset;
      if (target == address && traits_of(at.op).size == 4) return b;
      if ((target ^ address) / 8 == 0) return std::nullopt;  // another command begins
    } else if (is_load(at.op)) {
      result = loaded(memory, at, a + offset);
    } else if (at.op == Op::jal || at.op == Op::jalr) {
      result = next;
      next = at.op == Op::jal ? pc + offset : (a + offset) & ~1U;
    } else if (const auto is_taken = compare_of(at.op)) {
      if (is_taken(a, b)) next = pc + offset;
    } else if (at.op == Op::auipc) {
      result = pc + offset;
    } else {
      result = computed(at, a, b);
    }
    const bool has_result = !is_store(at.op) && !is_branch(at.op) && at.op != Op::fence;
    if (has_result && !result) return std::nullopt;
    if (result && at.rd != 0) x[at.rd] = *result;
    pc = next;
  }
  return std::nullopt;
}

}  // namespace mebots::soc
