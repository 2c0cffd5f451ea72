// SPDX-License-Identifier: Apache-2.0
#include "hart/fetch.hpp"

#include "hart/instruction.hpp"
#include "isa/encoding.hpp"
#include "mebots/assert.hpp"

#include <span>

namespace mebots::soc {

void Fetch::flush() {
  if (cache_ != nullptr) cache_->flush();
}

std::uint32_t Fetch::fetch_lines(const Instruction* at, std::uint64_t cycle) {
  MEBOTS_ASSERT(is_cached() && !is_block_end(at->op));
  std::uint32_t wait = 0;
  for (auto line = cache_->line_of(at->pc); line <= cache_->line_of(at[1].pc - 1); ++line) {
    wait += cache_->fetch(line, cycle + wait + execution_.host.tick_offset);
  }
  execution_.counters.fetch_cycles += wait;
  return wait;
}

const Instruction* Fetch::next_to_wait(const Instruction* at) const {
  MEBOTS_ASSERT(is_cached() && !is_block_end(at->op));
  auto line = cache_->line_of(at[1].pc - 1);
  for (++at; !is_block_end(at->op); ++at) {
    const auto last = cache_->line_of(at[1].pc - 1);
    if (last == line) continue;
    if (!cache_->has_arrived(last) || !cache_->has_arrived(cache_->line_of(at->pc))) return at;
    line = last;
  }
  return at;
}

bool Fetch::is_present(const Instruction* at) const {
  if (cache_ == nullptr) return true;
  const auto first = cache_->line_of(at->pc);
  while (!is_block_end(at->op)) ++at;
  for (auto line = first; line <= cache_->line_of(at->pc - 1); ++line) {
    if (!cache_->has_arrived(line)) return false;
  }
  return true;
}

namespace {

/// Maximum number of instructions that upcoming_store() executes. Compilers place fewer instructions between the two
/// halves of a 64-bit store.
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
      // The program starts another 64-bit store before this one is complete.
      if ((target ^ address) / 8 == 0) return std::nullopt;
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
