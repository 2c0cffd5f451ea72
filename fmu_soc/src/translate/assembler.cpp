// SPDX-License-Identifier: Apache-2.0
#include "translate/assembler.hpp"

#include "mebots/assert.hpp"
#include "translate/translator.hpp"

#include <limits>

namespace mebots::soc::translate {

using namespace Xbyak::util;

namespace {

constexpr std::size_t kAlignment = 16;

/// Required because offsetof() is only defined for standard-layout types.
static_assert(std::is_standard_layout_v<Execution>);

/// Writes host code for an instruction. Returns false if execution leaves the block at this instruction.
bool emit_instruction(Assembler& a, const Instruction* at) {
  const auto lowering = lowering_of(at->op);
  if (lowering == nullptr || !lowering(a, at)) {
    a.edges.resume(at);
    return false;
  }
  return !is_jump(at->op) && !is_trap(at->op) && !is_block_end(at->op);
}

void emit_node(Assembler& a, const Node& node) {
  const auto* at = node.first;
  if (a.blocks.fetched() == nullptr) {
    while (emit_instruction(a, at)) a.cycles.record_flow_inside(at++);
    return;
  }
  a.fetches.emit(*node.block, at);
  while (emit_instruction(a, at)) {
    a.cycles.record_flow_inside(at++);
    if (!is_block_end(at->op)) a.fetches.emit(*node.block, at);
  }
}

}  // namespace

Assembler::Assembler(const TranslationContext& context, std::size_t used, const Stubs& with_stubs)
    : CodeGenerator(context.code_memory.size() - used, context.code_memory.writable() + used),
      code_memory(context.code_memory),
      blocks(context.blocks),
      ram(context.ram),
      options(context.options),
      exits(context.exits),
      stubs(with_stubs) {}

bool Assembler::is_near(const void* table, std::size_t size) const {
  const auto distance = static_cast<const std::uint8_t*>(table) - ram[0].data;
  return distance >= std::numeric_limits<std::int32_t>::min() &&
         distance + static_cast<std::ptrdiff_t>(size) <= std::numeric_limits<std::int32_t>::max();
}

int Assembler::from_first_memory(const void* table) const {
  MEBOTS_ASSERT(is_near(table, 1));
  return static_cast<int>(static_cast<const std::uint8_t*>(table) - ram[0].data);
}

Xbyak::Address Assembler::marks_of_word(unsigned words) {
  MEBOTS_ASSERT(words == 1 || words == 2);
  const auto& frame = words == 1 ? byte : word;
  if (is_near(ram[0].marks, ram[0].span)) return frame[r14 + rcx + from_first_memory(ram[0].marks)];
  mov(rdx, ptr[rbx + static_cast<int>(offsetof(Execution, ram[0].marks))]);
  return frame[rdx + rcx];
}

void Assembler::emit_deferred() {
  while (!warm_.empty() || !cold_.empty()) {
    auto& pending = warm_.empty() ? cold_ : warm_;
    const auto emit_next = std::move(pending.front());
    pending.pop_front();
    emit_next();
  }
}

void Assembler::emit_constants() {
  align(kAlignment);
  for (auto& [value, label] : constants_) {
    L(label);
    dq(value.first);
    dq(value.second);
  }
}

std::vector<Entry> emit_region(Assembler& a, const Region& region) {
  a.registers.set_allocation(allocate(region));
  a.edges.begin(region);
  std::vector<Entry> entries(region.nodes.size());
  for (std::size_t i = entries.size(); i-- > 0;) entries[i] = a.edges.emit_entry(region.nodes[i], i == 0);
  for (std::size_t i = 0; i < region.nodes.size(); ++i) {
    a.edges.begin_node(i);
    emit_node(a, region.nodes[i]);
  }
  a.emit_deferred();
  a.edges.emit_exits();
  a.emit_constants();
  return entries;
}

}  // namespace mebots::soc::translate
