// SPDX-License-Identifier: Apache-2.0
//
// Ways out of a block: to another one of the region, to other translated code, back to the interpreter.
#include "translate/emitter.hpp"

#include <bit>

namespace mebots::soc::translate {

/// Adds up what a block has done when it is left behind `at`.
void Emitter::count(const Instruction* at, std::uint32_t extra_cycles) {
  const auto& sums = at[1];
  spend(sums.cycles_before + waits_before(&sums) + extra_cycles);
  const auto counts = std::uint64_t{sums.index} | std::uint64_t{sums.accesses_before} << 32;
  paddq(xmm15, ptr[rip + constants_[{counts, sums.energy_before_fj}]]);
}

void Emitter::spend(std::uint32_t cycles) {
  if (manner_.banks != nullptr) {
    add(r15, cycles * manner_.banks->count());
  } else {
    sub(r15, cycles);
  }
}

std::uint32_t Emitter::add_exit(const Exit& exit) {
  exits_.push_back(exit);
  if (exit.resumes || exit.straight) exits_.back().is_reached_straight = true;
  return static_cast<std::uint32_t>(exits_.size() - 1);
}

void Emitter::emit_leave(const Exit& exit) {
  mov(eax, add_exit(exit));
  jmp(leave_all_, T_NEAR);
}

/// The interpreter goes on with `at` and finishes the block.
void Emitter::emit_resume(const Instruction* at) {
  Exit exit;
  exit.resumes = true;
  exit.at = at;
  exit.wait_cycles = waits_before(at);
  emit_leave(exit);
}

/// Jumps when fewer cycles may still start than the block asks for, of which the first stall, or when its front must be
/// fetched first. With a loose limit a block asks for one cycle.
void Emitter::jump_at_limit(const Block& block, std::uint32_t stall, Label& leave) {
  if (!manner_.loose_limit) {
    cmp(r15, block.front_bound + stall);
    jle(leave, T_NEAR);
  } else if (manner_.banks != nullptr) {
    cmp(r15, ptr[rbx + static_cast<int>(offsetof(Execution, host.end))]);
    jae(leave, T_NEAR);
  } else {
    cmp(r15, 0);
    jle(leave, T_NEAR);
  }
  if (cache_.fetches()) jump_when_absent(block, block.front_end, leave);
}

/// Jumps when the block's code before `end` may not be in the instruction cache; rdx may be lost.
void Emitter::jump_when_absent(const Block& block, std::uint32_t end, Label& leave) {
  const auto* present_end = &block.present_end;
  if (near(present_end, sizeof *present_end)) {
    cmp(dword[r14 + from_first_memory(present_end)], end);
  } else {
    mov(rdx, reinterpret_cast<std::uint64_t>(present_end));
    cmp(dword[rdx], end);
  }
  jb(leave, T_NEAR);
}

/// A block may only begin when none of its instructions can start too late. `pipeline` is how it finds the pipeline.
void Emitter::check_limit(const Node& node, std::uint32_t stall, const Exit& at_limit, const Pipeline& pipeline) {
  Label leave;
  jump_at_limit(*node.block, stall, leave);
  later([this, &node, stall, at_limit, pipeline, leave]() mutable {
    L(leave);
    // With a stall, the next run may have to begin otherwise.
    if (stall == 0) {
      emit_park(node, at_limit, pipeline);
    } else {
      emit_leave(at_limit);
    }
  });
}

/// Leaves in front of a block so that the next run can begin with it without a look.
void Emitter::emit_park(const Node& node, const Exit& exit, const Pipeline& pipeline) {
  static_assert(sizeof(Pipeline) == sizeof(std::uint64_t));
  mov(dword[rbx + static_cast<int>(offsetof(Execution, pc))], node.block->pc);
  mov(dword[rbx + static_cast<int>(offsetof(Execution, next_block))], node.number);
  mov(rdx, std::bit_cast<std::uint64_t>(pipeline));
  mov(ptr[rbx + static_cast<int>(offsetof(Execution, pipeline))], rdx);
  mov(eax, add_exit(exit));
  lea(rdx, ptr[rip + entries_[index_of(node)]]);
  jmp(park_all_, T_NEAR);
}

/// Behind a jump.
void Emitter::check_limit(const Node& node) {
  Exit exit;
  exit.pc = node.block->pc;
  exit.block = node.number;
  check_limit(node, 0, exit, {});
  forget_what_came();
}

/// Leaves the block behind `at`, which is counted already but for an unaligned target.
void Emitter::emit_edge(const Instruction* at, std::uint32_t pc, bool jumped) {
  const auto extra = is_branch(at->op) ? kTakenBranchExtra : 0U;
  if (const auto* node = at->link != 0 ? region_->find(at->link) : nullptr; node != nullptr) {
    count(at, extra + (jumped && node->block->unaligned ? kUnalignedTargetExtra : 0U));
    check_limit(*node);
    if (is_branch(at->op) || node != following_) jmp(label_of(*node), T_NEAR);
    return;
  }
  count(at, extra);
  Exit exit;
  exit.pc = pc;
  exit.at = at;
  exit.jumped = jumped;
  emit_way(exit);
}

/// Leaves by an exit that may be led on.
void Emitter::emit_way(Exit exit) {
  store_registers();
  // To the next instruction until it is led elsewhere. The way stands in data: code is never changed.
  exit.way = &ways_.emplace_back();
  mov(rdx, reinterpret_cast<std::uint64_t>(exit.way));
  jmp(ptr[rdx]);
  *exit.way = code_memory_.executable(getCurr());
  mov(eax, add_exit(exit));
  jmp(gates_.leave, T_NEAR);
}

void Emitter::emit_branch(const Instruction* at) {
  Label taken;
  if (at->op == Op::p_beqimm || at->op == Op::p_bneimm) {
    cmp(value(at->rs1, eax), static_cast<std::uint32_t>(static_cast<std::int32_t>(std::uint32_t{at->rs2} << 27) >> 27));
  } else {
    emit_compare(at->rs1, at->rs2);
  }
  switch (at->op) {
    case Op::beq:
    case Op::p_beqimm:
      je(taken, T_NEAR);
      break;
    case Op::bne:
    case Op::p_bneimm:
      jne(taken, T_NEAR);
      break;
    case Op::blt:
      jl(taken, T_NEAR);
      break;
    case Op::bge:
      jge(taken, T_NEAR);
      break;
    case Op::bltu:
      jb(taken, T_NEAR);
      break;
    default:
      jae(taken, T_NEAR);
      break;
  }
  later([this, at, taken]() mutable {
    L(taken);
    emit_edge(at, static_cast<std::uint32_t>(at->imm), true);
  });
  if (cache_.fetches()) emit_fetch(at + 1);
}

/// Behind a branch that was not taken: goes on in the block when its code is there up to the next one.
void Emitter::emit_fetch(const Instruction* at) {
  if (is_block_end(at->op)) return;
  const auto* last = at;
  while (!is_block_end(last[1].op) && !is_branch(last->op)) ++last;
  Label absent;
  jump_when_absent(*block_, last[1].pc, absent);
  later([this, at, absent]() mutable {
    L(absent);
    Exit exit;
    exit.resumes = true;
    exit.fetches = true;
    exit.at = at;
    exit.wait_cycles = waits_before(at);
    emit_leave(exit);
  });
}

void Emitter::emit_jump(const Instruction* at) {
  if (at->rd != 32) set(at->rd, at[1].pc);
  emit_edge(at, static_cast<std::uint32_t>(at->imm), at->rs2 == 0);
}

void Emitter::emit_jump_register(const Instruction* at) {
  const auto base = value(at->rs1, eax);
  lea(eax, ptr[base.cvt64() + at->imm]);
  and_(eax, ~1U);
  if (at->rd != 32) set(at->rd, at[1].pc);
  // Where it went last is the best guess.
  if (const auto* node = at->link != 0 ? region_->find(at->link) : nullptr; node != nullptr) {
    Label guessed;
    cmp(eax, node->block->pc);
    je(guessed, T_NEAR);
    later([this, at, node, guessed]() mutable {
      L(guessed);
      count(at, node->block->unaligned ? kUnalignedTargetExtra : 0U);
      check_limit(*node);
      jmp(label_of(*node), T_NEAR);
    });
  }
  count(at, 0);
  store_registers();
  mov(ptr[rbx + static_cast<int>(offsetof(Execution, pc))], eax);
  Label unknown;
  mov(ecx, eax);
  and_(ecx, TargetTable::kMask);
  mov(rdx, reinterpret_cast<std::uint64_t>(targets_.targets.data()));
  static_assert(sizeof(TargetTable::Target) == 16 && TargetTable::kStep == 2);
  cmp(ptr[rdx + rcx * 8], eax);
  jne(unknown);
  jmp(ptr[rdx + rcx * 8 + 8]);
  L(unknown);
  Exit exit;
  exit.at = at;
  exit.jumped = true;
  exit.indirect = true;
  mov(eax, add_exit(exit));
  jmp(gates_.leave, T_NEAR);
}

}  // namespace mebots::soc::translate
