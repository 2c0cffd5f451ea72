// SPDX-License-Identifier: Apache-2.0
#include "translate/registers.hpp"

#include "mebots/assert.hpp"
#include "translate/assembler.hpp"

#include <algorithm>
#include <numeric>

namespace mebots::soc::translate {
namespace {

/// The host registers that hold guest registers, those with the shortest encodings first.
constexpr std::array<int, kHostRegisters> kHosts{Xbyak::Operand::RSI, Xbyak::Operand::RDI, Xbyak::Operand::RBP,
                                                 Xbyak::Operand::R8,  Xbyak::Operand::R9,  Xbyak::Operand::R10,
                                                 Xbyak::Operand::R11, Xbyak::Operand::R12, Xbyak::Operand::R13};
/// Numbers of uses of each guest register, weighted by Node::weight.
struct Uses {
  std::array<std::uint64_t, kGuestRegisters> all{};
  std::array<std::uint64_t, kGuestRegisters> in_vectors{};  // uses by dot products and floating-point operations

  void add(const Instruction& at, std::uint8_t reg, std::uint32_t weight) {
    all[reg] += weight;
    if (is_dot_product(at.op) || is_float(at.op)) in_vectors[reg] += weight;
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
      if (is_float_multiply_add(at->op)) counted.add(*at, third_register(*at), node.weight);
      registers.written[at->rd] = true;
      if (is_post_increment(at->op)) registers.written[at->rs1] = true;
    }
  }
  auto& uses = counted.all;
  uses[0] = 0;            // x0 is a constant
  uses[kNoRegister] = 0;  // never read
  std::array<std::uint8_t, kGuestRegisters> order{};
  std::iota(order.begin(), order.end(), std::uint8_t{0});
  const auto& vectors = counted.in_vectors;
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return vectors[a] > vectors[b]; });
  for (const auto reg : order) {
    if (registers.vector_count == kVectorRegisters || vectors[reg] == 0) break;
    if (uses[reg] == 0 || 2 * vectors[reg] < uses[reg]) continue;
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

using namespace Xbyak::util;

Xbyak::Address RegisterMap::memory(unsigned reg) {
  return dword[rbx + static_cast<int>(offsetof(Execution, x) + sizeof(std::uint32_t) * reg)];
}

RegisterMap::RegisterMap(Assembler& assembler) : a_(assembler) {
  for (unsigned reg = 0; reg < kGuestRegisters; ++reg) memory_operands_.push_back(memory(reg));
}

void RegisterMap::load_all() {
  for (unsigned i = 0; i < allocation_.count; ++i) a_.mov(Reg32(kHosts[i]), memory(allocation_.guest[i]));
  for (unsigned i = 0; i < allocation_.vector_count; ++i) {
    const auto guest = allocation_.vector_guest[i];
    a_.movd(vector(guest), memory(guest));
  }
}

void RegisterMap::store_all() {
  for (unsigned i = 0; i < allocation_.count; ++i) {
    const auto guest = allocation_.guest[i];
    if (allocation_.written[guest]) a_.mov(memory(guest), Reg32(kHosts[i]));
  }
  for (unsigned i = 0; i < allocation_.vector_count; ++i) {
    const auto guest = allocation_.vector_guest[i];
    if (allocation_.written[guest]) a_.movd(memory(guest), vector(guest));
  }
}

Xbyak::Reg32 RegisterMap::host(unsigned reg) const {
  MEBOTS_ASSERT(in_host(reg));
  return Reg32(kHosts[static_cast<std::uint8_t>(allocation_.host[reg])]);
}

Xbyak::Xmm RegisterMap::vector(unsigned reg) const {
  MEBOTS_ASSERT(in_vector(reg));
  return Xbyak::Xmm(kFirstVector + allocation_.vector[reg]);
}

const Xbyak::Operand& RegisterMap::operand(unsigned reg) {
  MEBOTS_ASSERT(reg != 0, "x0 has no place");
  MEBOTS_ASSERT(!in_vector(reg));
  static constexpr std::size_t kCount = kHosts.size();
  static const std::array<Reg32, kCount> kOperands{Reg32(kHosts[0]), Reg32(kHosts[1]), Reg32(kHosts[2]),
                                                   Reg32(kHosts[3]), Reg32(kHosts[4]), Reg32(kHosts[5]),
                                                   Reg32(kHosts[6]), Reg32(kHosts[7]), Reg32(kHosts[8])};
  if (in_host(reg)) return kOperands[static_cast<std::uint8_t>(allocation_.host[reg])];
  return memory_operands_[reg];
}

const Xbyak::Operand& RegisterMap::source(unsigned reg, const Reg32& scratch) {
  if (!in_vector(reg)) return operand(reg);
  copy(scratch, reg);
  return scratch;
}

Xbyak::Reg32 RegisterMap::value(unsigned reg, const Reg32& scratch) {
  if (in_host(reg)) return host(reg);
  copy(scratch, reg);
  return scratch;
}

Xbyak::Reg32 RegisterMap::place(unsigned rd, const Reg32& scratch, bool needed_later) const {
  return in_host(rd) && !needed_later ? host(rd) : scratch;
}

void RegisterMap::finish(unsigned rd, const Reg32& result) {
  MEBOTS_ASSERT(rd != 0, "results for x0 go to the last register");
  if (in_host(rd)) {
    if (host(rd).getIdx() != result.getIdx()) a_.mov(host(rd), result);
  } else if (in_vector(rd)) {
    a_.movd(vector(rd), result);
  } else {
    a_.mov(memory(rd), result);
  }
}

void RegisterMap::set(unsigned rd, std::uint32_t constant) {
  MEBOTS_ASSERT(rd != 0);
  if (in_vector(rd)) {
    a_.mov(ecx, constant);  // eax holds the target of a jump
    a_.movd(vector(rd), ecx);
  } else if (!in_host(rd)) {
    a_.mov(memory(rd), constant);
  } else if (constant == 0) {
    a_.xor_(host(rd), host(rd));
  } else {
    a_.mov(host(rd), constant);
  }
}

void RegisterMap::copy(const Reg32& to, unsigned reg) {
  MEBOTS_ASSERT(reg < kGuestRegisters);
  if (reg == 0) {
    a_.mov(to, 0);  // mov keeps the flags; xor would not
  } else if (in_vector(reg)) {
    a_.movd(to, vector(reg));
  } else if (!in_host(reg) || host(reg).getIdx() != to.getIdx()) {
    a_.mov(to, operand(reg));
  }
}

Xbyak::Xmm RegisterMap::in_vector_for(unsigned reg, const Xbyak::Xmm& scratch) {
  if (in_vector(reg)) return vector(reg);
  if (reg == 0) {
    a_.pxor(scratch, scratch);
  } else if (in_host(reg)) {
    a_.movd(scratch, host(reg));
  } else {
    a_.movd(scratch, memory(reg));
  }
  return scratch;
}

void RegisterMap::finish_vector(unsigned rd, const Xbyak::Xmm& result) {
  MEBOTS_ASSERT(rd != 0);
  if (in_vector(rd)) {
    if (vector(rd).getIdx() != result.getIdx()) a_.movdqa(vector(rd), result);
  } else if (in_host(rd)) {
    a_.movd(host(rd), result);
  } else {
    a_.movd(memory(rd), result);
  }
}

}  // namespace mebots::soc::translate
