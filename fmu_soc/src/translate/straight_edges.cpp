// SPDX-License-Identifier: Apache-2.0
// Writes the code that continues without a jump: from the end of a block to the next block or to the next iteration of
// a hardware loop.
#include "translate/assembler.hpp"

#include "mebots/assert.hpp"

#include <bit>

namespace mebots::soc::translate {

using namespace Xbyak::util;

namespace {

static_assert(offsetof(Pipeline, before) == 0 && offsetof(Pipeline, two_before) == 4 && sizeof(Previous) == 4);

}  // namespace

/// Returns the node to which a link at the end of a block leads. Returns null if the node is not in the region, or if
/// the previous instructions may change the cycles of a jump in the node.
const Node* EdgeWriter::straight_successor(const Instruction* at, std::uint32_t link) const {
  if (link == 0) return nullptr;
  const auto* node = a_.blocks.block(link).valid() ? region_->find(link) : nullptr;
  return node != nullptr && !delays_jump(a_.blocks, *node->block, at) ? node : nullptr;
}

void EdgeWriter::fall_through(const Instruction* at, std::uint32_t link, std::uint32_t pc, bool is_last) {
  MEBOTS_ASSERT(is_block_end(at->op) && at->index > 0);
  const auto* node = straight_successor(at, link);
  if (node != nullptr && node->block->pc == pc) {
    fall_through_to(at, *node, is_last);
    return;
  }
  a_.cycles.count(at - 1, 0);
  if (a_.cycles.is_noted(at - 1, pc)) a_.cycles.record_flow_to(at - 1, pc);
  Exit exit;
  exit.straight = true;
  exit.pc = pc;
  exit.at = at;
  save_pipeline_state(at);
  leave_chained(exit);
}

void EdgeWriter::fall_through_to(const Instruction* at, const Node& node, bool is_last) {
  a_.cycles.count(at - 1, 0);
  if (a_.cycles.is_noted(at - 1, node.block->pc)) a_.cycles.record_flow_to(at - 1, node.block->pc);
  save_pipeline_state(at);
  const bool stalls = translate::stalls(*node.block, at);
  Exit at_limit;
  at_limit.straight = true;
  at_limit.pc = node.block->pc;
  at_limit.block = node.number;
  at_limit.at = at;
  check_limit(node, stalls ? 1U : 0U, at_limit);
  if (stalls) {
    if (a_.blocks.fetched() != nullptr && a_.fetches.are_inline())
      a_.fetches.emit_first(*node.block, node.first);  // fetched before the stall
    a_.cycles.spend(1);
  }
  if (!is_last || &node != following_) a_.jmp(label_of(node), kNear);
}

/// The program may have changed the start of the loop since the last iteration. Therefore the code compares the start
/// before it jumps.
void EdgeWriter::iterate(const Instruction* at, unsigned loop) {
  MEBOTS_ASSERT(at->op == Op::loop_end && loop < 2);
  const auto start = dword[rbx + offset_of_loop(loop) + static_cast<int>(offsetof(HardwareLoop, start))];
  if (const auto link = at[1].link; link != 0 && a_.blocks.block(link).valid()) {
    const auto pc = a_.blocks.block(link).pc;
    Label elsewhere;
    a_.cmp(start, pc);
    a_.jne(elsewhere, kNear);
    fall_through(at, link, pc, false);
    a_.L(elsewhere);
  }
  a_.cycles.count(at - 1, 0);
  save_pipeline_state(at);
  a_.mov(eax, start);
  if (a_.options.flow != nullptr) a_.cycles.record_flow_to(at - 1, eax);
  a_.mov(ptr[rbx + static_cast<int>(offsetof(Execution, pc))], eax);
  Exit exit;
  exit.straight = true;
  exit.indirect = true;
  exit.at = at;
  leave_by(exit);
}

/// Writes code that stores the state of the pipeline for the next block, which follows `end` without a jump. All
/// instructions before `end` must have been counted. The code changes rcx and rdx.
void EdgeWriter::save_pipeline_state(const Instruction* end) {
  MEBOTS_ASSERT(is_block_end(end->op) && end->index > 0);
  const auto straight_pipeline = ptr[rbx + static_cast<int>(offsetof(Execution, host.straight_pipeline))];
  if (end->index >= 2) {
    a_.mov(rdx, bits_of({executed(end[-1], false), one_later(executed(end[-2], false))}));
    a_.mov(straight_pipeline, rdx);
    return;
  }
  // The pipeline contains the last two instructions. If the block has only one, the other one is the instruction before
  // the block. In the first block of a run, that instruction is in Execution::pipeline.
  Label straight;
  a_.mov(rdx, straight_pipeline);
  a_.test(rdx, rdx);
  a_.jnz(straight);
  a_.movd(ecx, xmm15);
  a_.mov(rdx, bits_of({}));
  a_.cmp(ecx, 1);
  a_.cmove(rdx, ptr[rbx + static_cast<int>(offsetof(Execution, pipeline))]);
  a_.L(straight);
  a_.and_(edx, ~(std::uint32_t{Previous::kSlow} << 8 * offsetof(Previous, pointer_and_slow)));  // one_later()
  a_.shl(rdx, 32);
  a_.mov(ecx, std::bit_cast<std::uint32_t>(executed(end[-1], false)));
  a_.or_(rdx, rcx);
  a_.mov(straight_pipeline, rdx);
}

/// Writes code that clears the stored state of the pipeline before a jump to a node.
void EdgeWriter::clear_pipeline_state() {
  a_.mov(qword[rbx + static_cast<int>(offsetof(Execution, host.straight_pipeline))], 0);
}

}  // namespace mebots::soc::translate
