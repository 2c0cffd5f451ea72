// SPDX-License-Identifier: Apache-2.0
//
// Hardware loops, and the end of a block that goes straight on.
#include "translate/emitter.hpp"

#include <bit>

namespace mebots::soc::translate {
namespace {

static_assert(offsetof(Pipeline, before) == 0 && offsetof(Pipeline, two_before) == 4 && sizeof(Previous) == 4);

}  // namespace

/// To the start of a loop, which is where it was last time or not.
void Emitter::emit_iteration(const Instruction* at, unsigned loop) {
  const auto start = dword[rbx + offset_of_loop(loop) + static_cast<int>(offsetof(HardwareLoop, start))];
  if (const auto link = at[1].link; link != 0 && blocks_.block(link).valid()) {
    const auto pc = blocks_.block(link).pc;
    Label elsewhere;
    cmp(start, pc);
    jne(elsewhere, T_NEAR);
    emit_straight_edge(at, link, pc, false);
    L(elsewhere);
  }
  count(at - 1, 0);
  note_what_came(at);
  mov(eax, start);
  if (options_.flow != nullptr) note_flow_to(at - 1, eax);
  mov(ptr[rbx + static_cast<int>(offsetof(Execution, pc))], eax);
  Exit exit;
  exit.straight = true;
  exit.indirect = true;
  exit.at = at;
  emit_leave(exit);
}

/// Where the end of a block leads by a link, if that is in the region and nothing but a stall depends on what came
/// before it.
const Node* Emitter::straight_successor(const Instruction* at, std::uint32_t link) const {
  if (link == 0) return nullptr;
  const auto* node = blocks_.block(link).valid() ? region_->find(link) : nullptr;
  return node != nullptr && !delays_jump(blocks_, *node->block, at) ? node : nullptr;
}

/// Straight on to the block at `pc`, to which a link has led. `is_last`: nothing else of its node comes behind it.
void Emitter::emit_straight_edge(const Instruction* at, std::uint32_t link, std::uint32_t pc, bool is_last) {
  const auto* node = straight_successor(at, link);
  if (node != nullptr && node->block->pc == pc) {
    emit_straight_to(at, *node, is_last);
    return;
  }
  count(at - 1, 0);
  if (is_noted(at - 1, pc)) note_flow_to(at - 1, pc);
  Exit exit;
  exit.straight = true;
  exit.pc = pc;
  exit.at = at;
  note_what_came(at);
  emit_chained_exit(exit);
}

/// Notes what the pipeline holds for the next block, which is reached straight behind `end`, up to which all is
/// counted. rcx and rdx are lost.
void Emitter::note_what_came(const Instruction* end) {
  const auto came_from = ptr[rbx + static_cast<int>(offsetof(Execution, host.came_from))];
  if (end->index >= 2) {
    mov(rdx, bits_of({executed(end[-1], false), one_later(executed(end[-2], false))}));
    mov(came_from, rdx);
    return;
  }
  // A block of one instruction: also what came before it, which of a run's first block the run has found.
  Label straight;
  mov(rdx, came_from);
  test(rdx, rdx);
  jnz(straight);
  movd(ecx, xmm15);
  mov(rdx, bits_of({}));
  cmp(ecx, 1);
  cmove(rdx, ptr[rbx + static_cast<int>(offsetof(Execution, pipeline))]);
  L(straight);
  and_(edx, ~(0xffU << 8 * offsetof(Previous, slow)));  // one_later()
  shl(rdx, 32);
  mov(ecx, std::bit_cast<std::uint32_t>(executed(end[-1], false)));
  or_(rdx, rcx);
  mov(came_from, rdx);
}

void Emitter::emit_straight_to(const Instruction* at, const Node& node, bool is_last) {
  count(at - 1, 0);
  if (is_noted(at - 1, node.block->pc)) note_flow_to(at - 1, node.block->pc);
  note_what_came(at);
  const bool stalls = translate::stalls(*node.block, at);
  Exit at_limit;
  at_limit.straight = true;
  at_limit.pc = node.block->pc;
  at_limit.block = node.number;
  at_limit.at = at;
  check_limit(node, stalls ? 1U : 0U, at_limit);
  if (stalls) {
    if (blocks_.fetched() != nullptr && fetches_inline())
      emit_fetch(*node.block, node.first, nullptr);  // before it stalls
    spend(1);
  }
  if (!is_last || &node != following_) jmp(label_of(node), T_NEAR);
}

/// Before a jump to a node: nothing came straight.
void Emitter::forget_what_came() {
  mov(qword[rbx + static_cast<int>(offsetof(Execution, host.came_from))], 0);
}

}  // namespace mebots::soc::translate
