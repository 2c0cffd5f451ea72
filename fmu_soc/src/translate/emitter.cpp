// SPDX-License-Identifier: Apache-2.0
#include "translate/emitter.hpp"

#include "mebots/assert.hpp"
#include "translate/lowering.hpp"

namespace mebots::soc::translate {
namespace {

/// The registers of the host that hold guest registers, in the order of `Registers`. The first ones make the
/// shortest code.
constexpr std::array<int, kHostRegisters> kHosts{Xbyak::Operand::RSI, Xbyak::Operand::RDI, Xbyak::Operand::RBP,
                                                 Xbyak::Operand::R8,  Xbyak::Operand::R9,  Xbyak::Operand::R10,
                                                 Xbyak::Operand::R11, Xbyak::Operand::R12, Xbyak::Operand::R13};
constexpr std::size_t kAlignment = 16;

/// The compiler must not take offsets for those of another type.
static_assert(std::is_standard_layout_v<Execution>);

}  // namespace

Emitter::Emitter(const CodeMemory& code_memory, std::size_t used, const BlockCache& blocks, const Execution& execution,
                 const Options& options, ExitTable& exits)
    : CodeGenerator(code_memory.size() - used, code_memory.writable() + used),
      ram_{execution.ram[0], execution.ram[1]},
      code_memory_(code_memory),
      blocks_(blocks),
      options_(options),
      exits_(exits) {
  for (unsigned reg = 0; reg < execution.x.size(); ++reg) memory_operands_.push_back(memory(reg));
}

std::vector<Entry> Emitter::emit(const Region& region, const Registers& registers, const Gates& gates) {
  region_ = &region;
  registers_ = &registers;
  gates_ = gates;
  labels_ = std::vector<Label>(region.nodes.size());
  entries_ = std::vector<Label>(region.nodes.size());
  stalled_entries_ = std::vector<Label>(region.nodes.size());
  std::vector<Entry> entries(region.nodes.size());
  for (std::size_t i = entries.size(); i-- > 0;) entries[i] = emit_entry(region.nodes[i], i == 0);

  for (std::size_t i = 0; i < region.nodes.size(); ++i) {
    following_ = i + 1 < region.nodes.size() ? &region.nodes[i + 1] : nullptr;
    L(labels_[i]);
    emit_node(region.nodes[i]);
  }
  emit_warm_and_cold();
  L(leave_all_);
  store_registers();
  jmp(gates_.leave);
  L(park_all_);
  store_registers();
  jmp(gates_.park);

  align(kAlignment);
  for (auto& [counts, label] : constants_) {
    L(label);
    dq(counts.first);
    dq(counts.second);
  }
  return entries;
}

/// What has been put off, and what that puts off.
void Emitter::emit_warm_and_cold() {
  while (!warm_.empty() || !cold_.empty()) {
    auto& pending = warm_.empty() ? cold_ : warm_;
    const auto emit_next = std::move(pending.front());
    pending.pop_front();
    emit_next();
  }
}

/// The ways into a node from outside. The code goes on with it, when that is what comes next, or jumps there.
Entry Emitter::emit_entry(const Node& node, bool runs_into_node) {
  Entry entry;
  Exit at_limit;
  at_limit.pc = node.block->pc;
  at_limit.block = node.number;
  const auto check = [this, &node, at_limit](bool is_reached_straight, std::uint32_t stall) {
    Label leave;
    jump_at_limit(*node.block, stall, leave);
    later([this, &node, at_limit, is_reached_straight, stall, leave]() mutable {
      L(leave);
      at_limit.is_reached_straight = is_reached_straight;
      if (options_.loose_limit) {
        emit_park_at_entry(node, at_limit, stall);
        return;
      }
      mov(eax, add_exit(at_limit));
      jmp(gates_.leave, T_NEAR);
    });
  };
  Label inside;
  entry.stalled = code_memory_.executable(getCurr());
  L(stalled_entries_[index_of(node)]);
  check(true, 1);
  if (blocks_.fetched() != nullptr && fetches_inline())
    emit_fetch(*node.block, node.first, nullptr);  // before it stalls
  spend(1);
  jmp(inside);
  entry.straight = code_memory_.executable(getCurr());
  check(true, 0);
  jmp(inside);
  entry.jumped = code_memory_.executable(getCurr());
  if (node.block->unaligned) spend(kUnalignedTargetExtra);
  entry.plain = code_memory_.executable(getCurr());
  L(entries_[index_of(node)]);
  check(false, 0);
  forget_what_came();
  L(inside);
  load_registers();
  if (!runs_into_node) jmp(label_of(node), T_NEAR);
  return entry;
}

void Emitter::emit_node(const Node& node) {
  const auto* at = node.first;
  if (blocks_.fetched() == nullptr) {
    while (emit_instruction(at)) note_flow_inside(at++);
    return;
  }
  // With a cache that others use, too, who begins the block has asked for its first line.
  if (fetches_inline()) emit_fetch(*node.block, at, nullptr);
  while (emit_instruction(at)) {
    note_flow_inside(at++);
    if (!is_block_end(at->op)) emit_fetch(*node.block, at, at - 1);
  }
}

/// False: the block is left here.
bool Emitter::emit_instruction(const Instruction* at) {
  const auto lowering = lowering_of(at->op);
  if (lowering == nullptr || !lowering(*this, at)) {
    emit_resume(at);
    return false;
  }
  return !is_jump(at->op) && !is_block_end(at->op);
}

void Emitter::load_registers() {
  for (unsigned i = 0; i < registers_->count; ++i) mov(Reg32(kHosts[i]), memory(registers_->guest[i]));
  for (unsigned i = 0; i < registers_->vector_count; ++i) {
    const auto guest = registers_->vector_guest[i];
    movd(vector(guest), memory(guest));
  }
}

void Emitter::store_registers() {
  for (unsigned i = 0; i < registers_->count; ++i) {
    const auto guest = registers_->guest[i];
    if (registers_->written[guest]) mov(memory(guest), Reg32(kHosts[i]));
  }
  for (unsigned i = 0; i < registers_->vector_count; ++i) {
    const auto guest = registers_->vector_guest[i];
    if (registers_->written[guest]) movd(memory(guest), vector(guest));
  }
}

Xbyak::Reg32 Emitter::host(unsigned reg) const {
  return Reg32(kHosts[static_cast<std::uint8_t>(registers_->host[reg])]);
}

Xbyak::Xmm Emitter::vector(unsigned reg) const {
  MEBOTS_ASSERT(in_vector(reg));
  return Xbyak::Xmm(kFirstVector + registers_->vector[reg]);
}

const Xbyak::Operand& Emitter::operand(unsigned reg) {
  MEBOTS_ASSERT(!in_vector(reg));
  static constexpr std::size_t kCount = kHosts.size();
  static const std::array<Reg32, kCount> kOperands{Reg32(kHosts[0]), Reg32(kHosts[1]), Reg32(kHosts[2]),
                                                   Reg32(kHosts[3]), Reg32(kHosts[4]), Reg32(kHosts[5]),
                                                   Reg32(kHosts[6]), Reg32(kHosts[7]), Reg32(kHosts[8])};
  if (in_host(reg)) return kOperands[static_cast<std::uint8_t>(registers_->host[reg])];
  return memory_operands_[reg];
}

const Xbyak::Operand& Emitter::source(unsigned reg, const Reg32& scratch) {
  if (!in_vector(reg)) return operand(reg);
  copy(scratch, reg);
  return scratch;
}

Xbyak::Reg32 Emitter::value(unsigned reg, const Reg32& scratch) {
  if (in_host(reg)) return host(reg);
  copy(scratch, reg);
  return scratch;
}

Xbyak::Reg32 Emitter::place(unsigned rd, const Reg32& scratch, bool needed_later) const {
  return in_host(rd) && !needed_later ? host(rd) : scratch;
}

void Emitter::finish(unsigned rd, const Reg32& result) {
  if (in_host(rd)) {
    if (host(rd).getIdx() != result.getIdx()) mov(host(rd), result);
  } else if (in_vector(rd)) {
    movd(vector(rd), result);
  } else {
    mov(memory(rd), result);
  }
}

void Emitter::set(unsigned rd, std::uint32_t constant) {
  if (in_vector(rd)) {
    mov(ecx, constant);  // eax holds where a jump leads
    movd(vector(rd), ecx);
  } else if (!in_host(rd)) {
    mov(memory(rd), constant);
  } else if (constant == 0) {
    xor_(host(rd), host(rd));
  } else {
    mov(host(rd), constant);
  }
}

void Emitter::copy(const Reg32& to, unsigned reg) {
  if (reg == 0) {
    mov(to, 0);  // not xor: flags stay
  } else if (in_vector(reg)) {
    movd(to, vector(reg));
  } else if (!in_host(reg) || host(reg).getIdx() != to.getIdx()) {
    mov(to, operand(reg));
  }
}

Xbyak::Xmm Emitter::in_vector_for(unsigned reg, const Xbyak::Xmm& scratch) {
  if (in_vector(reg)) return vector(reg);
  if (reg == 0) {
    pxor(scratch, scratch);
  } else if (in_host(reg)) {
    movd(scratch, host(reg));
  } else {
    movd(scratch, memory(reg));
  }
  return scratch;
}

void Emitter::finish_vector(unsigned rd, const Xbyak::Xmm& result) {
  if (in_vector(rd)) {
    if (vector(rd).getIdx() != result.getIdx()) movdqa(vector(rd), result);
  } else if (in_host(rd)) {
    movd(host(rd), result);
  } else {
    movd(memory(rd), result);
  }
}

}  // namespace mebots::soc::translate
