// SPDX-License-Identifier: Apache-2.0
#include "translate/edge_writer.hpp"

#include "mebots/assert.hpp"
#include "translate/assembler.hpp"

#include <bit>

namespace mebots::soc::translate {

using namespace Xbyak::util;

namespace {

/// Alignment of loops. A loop begins at a cache line of the host, so that its speed does not depend on the code before
/// it.
constexpr std::size_t kLoopAlignment = 64;

}  // namespace

void EdgeWriter::begin(const Region& region) {
  MEBOTS_ASSERT(!region.nodes.empty());
  region_ = &region;
  labels_ = std::vector<Label>(region.nodes.size());
  entries_ = std::vector<Label>(region.nodes.size());
  stalled_entries_ = std::vector<Label>(region.nodes.size());
}

void EdgeWriter::begin_node(std::size_t index) {
  MEBOTS_ASSERT(index < labels_.size());
  present_ = &region_->nodes[index];
  following_ = index + 1 < region_->nodes.size() ? &region_->nodes[index + 1] : nullptr;
  if (present_->is_loop_head) a_.align(kLoopAlignment);
  a_.L(labels_[index]);
}

void EdgeWriter::emit_exits() {
  MEBOTS_ASSERT(a_.stubs.leave != nullptr && a_.stubs.park != nullptr);
  a_.L(leave_all_);
  a_.registers.store_all();
  a_.jmp(a_.stubs.leave);
  if (a_.stubs.perform != nullptr) {
    a_.L(perform_all_);
    a_.registers.store_all();
    a_.jmp(a_.stubs.perform);
  }
  a_.L(park_all_);
  a_.registers.store_all();
  a_.jmp(a_.stubs.park);
}

std::uint32_t EdgeWriter::add_exit(const Exit& exit) {
  auto added = exit;
  if (exit.resumes || exit.straight) added.is_reached_straight = true;
  return a_.exits.add(added);
}

void EdgeWriter::leave_by(const Exit& exit) {
  a_.mov(eax, add_exit(exit));
  a_.jmp(leave_all_, kNear);
}

void EdgeWriter::resume(const Instruction* at) {
  MEBOTS_ASSERT(!is_block_end(at->op), "nothing is left to run there");
  Exit exit;
  exit.resumes = true;
  exit.at = at;
  exit.wait_cycles = a_.cycles.waits_before(at);
  a_.fetches.undo_after(at);
  if (a_.stubs.perform == nullptr) {
    leave_by(exit);
    return;
  }
  a_.mov(eax, add_exit(exit));
  a_.jmp(perform_all_, kNear);
}

/// Returns the region's node to which `link` leads, or null if the region has no such node or the node does not start
/// at `pc`.
const Node* EdgeWriter::node_at(std::uint32_t link, std::uint32_t pc) const {
  const auto number = linked(a_.blocks, link, pc);
  return number == 0 ? nullptr : region_->find(number);
}

/// Writes an exit before a block, taken if the limit does not allow the block to begin.
void EdgeWriter::check_limit(const Node& node, std::uint32_t stall, const Exit& at_limit) {
  Label leave;
  a_.cycles.jump_at_limit(*node.block, stall, leave);
  a_.defer_cold([this, &node, stall, at_limit, leave]() mutable {
    a_.L(leave);
    // If blocks must not run past the limit, the next run may have to begin in the interpreter, because a block with a
    // stall needs one more cycle before the limit.
    if (stall == 0 || a_.options.loose_limit) {
      park(node, at_limit, stall);
    } else {
      leave_by(at_limit);
    }
  });
}

/// Writes, after a jump to a node, the check of the limit, and the exit that is taken if the limit does not allow the
/// node's block to begin.
void EdgeWriter::check_limit(const Node& node) {
  Exit exit;
  exit.pc = node.block->pc;
  exit.block = node.number;
  check_limit(node, 0, exit);
  clear_pipeline_state();
}

/// Writes code that stores the pc and the block, for a run that begins in the interpreter.
void EdgeWriter::store_next_block(const Node& node) {
  a_.mov(dword[rbx + static_cast<int>(offsetof(Execution, pc))], node.block->pc);
  a_.mov(dword[rbx + static_cast<int>(offsetof(Execution, next_block))], node.number);
}

/// Writes code that loads the resume point of the hart that runs after this one into rcx, or 0 if no hart follows. The
/// host often mispredicts the jump to this address, and detects the error only after this load. Therefore the load
/// comes before other code.
void EdgeWriter::load_next_point() {
  if (a_.options.banks == nullptr) return;  // there are no rounds
  a_.mov(rcx, ptr[rbx + static_cast<int>(offsetof(Execution, host.resume_point_of_next))]);
  a_.mov(rcx, ptr[rcx]);
}

/// Writes an exit before a block, and sets a resume point so that the next run begins with this block. The next run
/// counts the cycle of the stall.
void EdgeWriter::park(const Node& node, const Exit& exit, std::uint32_t stall) {
  static_assert(sizeof(Pipeline) == sizeof(std::uint64_t));
  load_next_point();
  store_next_block(node);
  if (exit.straight) {
    a_.mov(rdx, ptr[rbx + static_cast<int>(offsetof(Execution, host.straight_pipeline))]);
  } else {
    a_.mov(rdx, bits_of({}));
  }
  a_.mov(ptr[rbx + static_cast<int>(offsetof(Execution, pipeline))], rdx);
  a_.mov(eax, add_exit(exit));
  a_.lea(rdx, ptr[rip + (stall == 0 ? entries_ : stalled_entries_)[index_of(node)]]);
  a_.jmp(park_all_, kNear);
}

/// Writes the exit that is taken at an entry of a node, before guest registers are loaded, if the limit does not allow
/// the block to begin. Stores the state of the pipeline in Execution::pipeline. After a fall-through, this state is in
/// HostState::straight_pipeline. After a jump, the pipeline is empty. At the start of a run, Execution::pipeline is
/// still valid.
void EdgeWriter::park_at_entry(const Node& node, const Exit& exit, std::uint32_t stall) {
  const auto pipeline = ptr[rbx + static_cast<int>(offsetof(Execution, pipeline))];
  load_next_point();
  store_next_block(node);
  if (exit.is_reached_straight) {
    a_.mov(rdx, ptr[rbx + static_cast<int>(offsetof(Execution, host.straight_pipeline))]);
    a_.mov(pipeline, rdx);
  } else {
    Label begun;
    a_.movd(edx, xmm15);
    a_.test(edx, edx);
    a_.jz(begun);
    a_.mov(rdx, bits_of({}));
    a_.mov(pipeline, rdx);
    a_.L(begun);
  }
  a_.mov(eax, add_exit(exit));
  a_.lea(rdx, ptr[rip + (stall == 0 ? entries_ : stalled_entries_)[index_of(node)]]);
  a_.jmp(a_.stubs.park, kNear);
}

Entry EdgeWriter::emit_entry(const Node& node, bool runs_into_node) {
  MEBOTS_ASSERT(node.block->valid());
  Entry entry;
  Exit at_limit;
  at_limit.pc = node.block->pc;
  at_limit.block = node.number;
  const auto check = [this, &node, at_limit](bool is_reached_straight, std::uint32_t stall) {
    Label leave;
    a_.cycles.jump_at_limit(*node.block, stall, leave);
    a_.defer_cold([this, &node, at_limit, is_reached_straight, stall, leave]() mutable {
      a_.L(leave);
      at_limit.is_reached_straight = is_reached_straight;
      if (a_.options.loose_limit) {
        park_at_entry(node, at_limit, stall);
        return;
      }
      a_.mov(eax, add_exit(at_limit));
      a_.jmp(a_.stubs.leave, kNear);
    });
  };
  Label inside;
  entry.stalled = a_.code_memory.executable(a_.getCurr());
  a_.L(stalled_entries_[index_of(node)]);
  check(true, 1);
  if (a_.blocks.fetched() != nullptr && a_.fetches.are_inline())
    a_.fetches.emit_first(*node.block, node.first);  // fetched before the stall
  a_.cycles.spend(1);
  a_.jmp(inside);
  entry.straight = a_.code_memory.executable(a_.getCurr());
  check(true, 0);
  a_.jmp(inside);
  entry.jumped = a_.code_memory.executable(a_.getCurr());
  if (node.block->unaligned) a_.cycles.spend(kUnalignedTargetExtra);
  entry.plain = a_.code_memory.executable(a_.getCurr());
  a_.L(entries_[index_of(node)]);
  check(false, 0);
  clear_pipeline_state();
  a_.L(inside);
  a_.registers.load_all();
  if (!runs_into_node) a_.jmp(label_of(node), kNear);
  return entry;
}

/// Writes a jump out of the block. The code counts all cycles and instructions of the block up to the jump, except for
/// the cycle of an unaligned target.
void EdgeWriter::jump(const Instruction* at, std::uint32_t pc, bool jumped) {
  MEBOTS_ASSERT(is_branch(at->op) || is_jump(at->op));
  const auto extra = is_branch(at->op) ? kTakenBranchExtra : 0U;
  if (const auto* node = node_at(at->link, pc); node != nullptr) {
    const auto landing = jumped && node->block->unaligned ? kUnalignedTargetExtra : 0U;
    if (a_.cycles.is_noted(at, pc)) {
      a_.cycles.count(at, extra);
      a_.cycles.record_flow_to(at, pc);
      a_.cycles.spend(landing);
    } else {
      a_.cycles.count(at, extra + landing);
    }
    check_limit(*node);
    if (is_branch(at->op) || node != following_) a_.jmp(label_of(*node), kNear);
    return;
  }
  a_.cycles.count(at, extra);
  if (a_.cycles.is_noted(at, pc)) a_.cycles.record_flow_to(at, pc);
  Exit exit;
  exit.pc = pc;
  exit.at = at;
  exit.jumped = jumped;
  leave_chained(exit);
}

void EdgeWriter::enter_handler(const Instruction* at, std::uint32_t pc) {
  MEBOTS_ASSERT(at->op == Op::ecall);
  // An ecall does not retire, so the run may have counted no instruction yet. The code of edges and exits then uses
  // Execution::pipeline, as in the first block of a run. Therefore it is cleared here.
  a_.mov(rax, bits_of({}));
  a_.mov(ptr[rbx + static_cast<int>(offsetof(Execution, pipeline))], rax);
  a_.fetches.forget_group();
  if (const auto* node = node_at(at->link, pc); node != nullptr) {
    check_limit(*node);
    if (node != following_) a_.jmp(label_of(*node), kNear);
    return;
  }
  Exit exit;
  exit.pc = pc;
  exit.at = at;
  leave_chained(exit);
}

/// Writes an exit whose jump can be changed later, so that it leads to the code of the next block.
void EdgeWriter::leave_chained(Exit exit) {
  MEBOTS_ASSERT(exit.patch_point == 0 && !exit.indirect);
  a_.registers.store_all();
  // Until a patch point is patched, it leads to the next instruction. The target of the jump is data, so that patching
  // does not change code.
  exit.patch_point = a_.exits.add_patch_point();
  constexpr auto kJumpBytes = 6;
  a_.jmp(ptr[rip + static_cast<int>(a_.exits.place_of(exit.patch_point) - (a_.getCurr() + kJumpBytes))]);
  a_.exits.set_unpatched(exit.patch_point, a_.code_memory.executable(a_.getCurr()));
  a_.mov(eax, add_exit(exit));
  a_.jmp(a_.stubs.leave, kNear);
}

void EdgeWriter::jump_indirect(const Instruction* at) {
  MEBOTS_ASSERT(at->op == Op::jalr || at->op == Op::mret);
  const bool jumped = is_jump(at->op);  // mret takes no further cycle for an unaligned target
  // The most likely target of an indirect jump is its previous target.
  if (const auto* node = at->link != 0 ? region_->find(at->link) : nullptr; node != nullptr) {
    Label guessed;
    a_.cmp(eax, node->block->pc);
    a_.je(guessed, kNear);
    a_.defer_warm([this, at, node, jumped, guessed]() mutable {
      a_.L(guessed);
      const auto landing = jumped && node->block->unaligned ? kUnalignedTargetExtra : 0U;
      if (a_.options.flow != nullptr) {
        a_.cycles.count(at, 0);
        a_.cycles.record_flow_to(at, eax);
        a_.cycles.spend(landing);
      } else {
        a_.cycles.count(at, landing);
      }
      check_limit(*node);
      a_.jmp(label_of(*node), kNear);
    });
  }
  a_.cycles.count(at, 0);
  if (a_.options.flow != nullptr) a_.cycles.record_flow_to(at, eax);
  a_.registers.store_all();
  a_.mov(ptr[rbx + static_cast<int>(offsetof(Execution, pc))], eax);
  Label unknown;
  a_.mov(ecx, eax);
  a_.and_(ecx, TargetTable::kMask);
  a_.mov(rdx, reinterpret_cast<std::uint64_t>(a_.exits.targets.data()));
  using Target = TargetTable::Target;
  static_assert(sizeof(Target) == 16 && TargetTable::kStep == 2);
  const auto field = [](std::size_t offset) { return rdx + rcx * 8 + static_cast<int>(offset); };
  a_.cmp(dword[field(offsetof(Target, pc))], eax);
  a_.jne(unknown);
  if (jumped) {
    a_.jmp(ptr[field(offsetof(Target, jumped))]);
  } else {
    a_.mov(eax, dword[field(offsetof(Target, from_jumped_to_plain))]);
    a_.add(rax, ptr[field(offsetof(Target, jumped))]);
    a_.jmp(rax);
  }
  a_.L(unknown);
  Exit exit;
  exit.at = at;
  exit.jumped = jumped;
  exit.indirect = true;
  a_.mov(eax, add_exit(exit));
  a_.jmp(a_.stubs.leave, kNear);
}

}  // namespace mebots::soc::translate
