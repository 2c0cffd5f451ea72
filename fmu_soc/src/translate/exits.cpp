// SPDX-License-Identifier: Apache-2.0
//
// Ways out of a block: to another one of the region, to other translated code, back to the interpreter.
#include "translate/emitter.hpp"

#include <algorithm>
#include <bit>

namespace mebots::soc::translate {

/// Adds up what a block has done when it is left behind `at`.
void Emitter::count(const Instruction* at, std::uint32_t extra_cycles) {
  const auto& sums = at[1];
  spend(sums.cycles_before + waits_before(&sums) + extra_cycles);
  const auto counts = std::uint64_t{sums.index} | std::uint64_t{sums.accesses_before} << 32;
  paddq(xmm15, ptr[rip + constants_[{counts, sums.energy_before_fj}]]);
}

/// Undoes count().
void Emitter::take_back(const Instruction* at) {
  const auto& sums = at[1];
  const auto cycles = sums.cycles_before + waits_before(&sums);
  if (options_.banks != nullptr) {
    sub(r15, cycles * options_.banks->count());
  } else {
    add(r15, cycles);
  }
  const auto counts = std::uint64_t{sums.index} | std::uint64_t{sums.accesses_before} << 32;
  psubq(xmm15, ptr[rip + constants_[{counts, sums.energy_before_fj}]]);
}

/// Whether a step must be noted for those who watch.
bool Emitter::is_noted(const Instruction* at, std::uint32_t next) const {
  if (options_.flow == nullptr) return false;
  return (at->op == Op::jal && at->rd != 32) || options_.flow->leads_away(at->pc, next);
}

/// Notes a step behind `at`, up to which all is counted, to where `set_next` stores. rcx and rdx are lost.
template <typename SetNext>
void Emitter::note_flow(const Instruction* at, SetNext set_next) {
  const auto field = [this](std::size_t offset) { return rdx + static_cast<int>(offset); };
  const auto end = rbx + static_cast<int>(offsetof(Execution, host.flow));
  mov(rdx, ptr[end]);
  movdqu(ptr[field(offsetof(Flow, instructions))], xmm15);
  mov(ptr[field(offsetof(Flow, cycles))], r15);
  mov(rcx, ptr[rbx + static_cast<int>(offsetof(Execution, counters.far_accesses))]);
  mov(ptr[field(offsetof(Flow, far_accesses))], rcx);
  mov(rcx, ptr[rbx + static_cast<int>(offsetof(Execution, counters.fetch_cycles))]);
  mov(ptr[field(offsetof(Flow, fetch_cycles))], rcx);
  mov(rcx, reinterpret_cast<std::uint64_t>(at));
  mov(ptr[field(offsetof(Flow, at))], rcx);
  set_next(dword[field(offsetof(Flow, next))]);
  add(qword[end], static_cast<std::uint32_t>(sizeof(Flow)));
}

void Emitter::note_flow_to(const Instruction* at, std::uint32_t next) {
  note_flow(at, [this, next](const Xbyak::Address& place) { mov(place, next); });
}

/// Likewise, to the address in `next`.
void Emitter::note_flow_to(const Instruction* at, const Reg32& next) {
  note_flow(at, [this, next](const Xbyak::Address& place) { mov(place, next); });
}

/// A step within the block, whose counts are not added before it is left.
void Emitter::note_flow_inside(const Instruction* at) {
  if (is_block_end(at[1].op) || !is_noted(at, at[1].pc)) return;
  count(at, 0);
  note_flow_to(at, at[1].pc);
  take_back(at);
}

void Emitter::spend(std::uint32_t cycles) {
  if (cycles == 0) return;
  if (options_.banks != nullptr) {
    add(r15, cycles * options_.banks->count());
  } else {
    sub(r15, cycles);
  }
}

void Emitter::spend(const Xbyak::Reg64& cycles) {
  if (options_.banks != nullptr) {
    shl(cycles.cvt32(), std::countr_zero(options_.banks->count()));
    add(r15, cycles);
  } else {
    sub(r15, cycles);
  }
}

std::uint32_t Emitter::add_exit(const Exit& exit) {
  auto added = exit;
  if (exit.resumes || exit.straight) added.is_reached_straight = true;
  return exits_.add(added);
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

/// Jumps when fewer cycles may still start than the block asks for, of which the first stall. With a loose limit a
/// block asks for one cycle, and for the lines of its first instruction: others use the cache, too.
void Emitter::jump_at_limit(const Block& block, std::uint32_t stall, Label& leave) {
  if (!options_.loose_limit) {
    cmp(r15, blocks_.fetch_bound(block) + stall);
    jle(leave, T_NEAR);
  } else if (options_.banks != nullptr) {
    cmp(r15, ptr[rbx + static_cast<int>(offsetof(Execution, host.end))]);
    jae(leave, T_NEAR);
  } else {
    cmp(r15, 0);
    jle(leave, T_NEAR);
  }
  if (blocks_.fetched() != nullptr && !fetches_inline()) {
    jump_when_absent(block.pc, leave);
    if (block.begins_across) jump_when_absent(block.pc + 2, leave);
  }
}

/// Sets the zero flag when the line of this code has not arrived in the instruction cache; rdx may be lost.
void Emitter::compare_presence(std::uint32_t address) {
  const auto* present = blocks_.fetched()->presence(address);
  if (near(present, 1)) {
    cmp(byte[r14 + from_first_memory(present)], 0);
  } else {
    mov(rdx, reinterpret_cast<std::uint64_t>(present));
    cmp(byte[rdx], 0);
  }
}

/// Jumps when it is not; likewise.
void Emitter::jump_when_absent(std::uint32_t address, Label& absent) {
  compare_presence(address);
  je(absent, T_NEAR);
}

/// In front of an instruction: brings those of its lines that are absent, but for the last one of the instruction
/// before. Where others use the cache, leaves that to the interpreter. eax, rcx and rdx may be lost.
void Emitter::emit_fetch(const Block& block, const Instruction* at, const Instruction* before) {
  const auto& cache = *blocks_.fetched();
  const auto last = cache.line_of(at[1].pc - 1);
  for (auto line = cache.line_of(at->pc); line <= last; ++line) {
    if (before != nullptr && line == cache.line_of(before[1].pc - 1)) continue;
    const auto address = std::max(at->pc, cache.address_of(line));
    if (fetches_inline()) {
      emit_fetch_line(line, address, block.is_often_absent());
      continue;
    }
    Label absent;
    jump_when_absent(address, absent);
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
}

/// Brings the line of this code when it is absent. What is seldom so stands aside: a jump fewer where it is present,
/// and two more, to code elsewhere and back, where it is not.
void Emitter::emit_fetch_line(std::uint32_t line, std::uint32_t address, bool often_absent) {
  Label present;
  if (often_absent) {
    compare_presence(address);
    jne(present);
    emit_refill(line, address);
    L(present);
    return;
  }
  Label absent;
  jump_when_absent(address, absent);
  L(present);
  aside([this, line, address, absent, present]() mutable {
    L(absent);
    emit_refill(line, address);
    jmp(present, T_NEAR);
  });
}

/// Brings an absent line; eax, rcx and rdx are lost.
void Emitter::emit_refill(std::uint32_t line, std::uint32_t address) {
  const auto* present = blocks_.fetched()->presence(address);
  mov(eax, blocks_.fetched()->first_of_set(line));
  mov(edx, line);
  if (near(present, 1)) {
    lea(rcx, ptr[r14 + from_first_memory(present)]);
  } else {
    mov(rcx, reinterpret_cast<std::uint64_t>(present));
  }
  call(gates_.fetch);
}

/// The node of the region to which a link has led, at `pc`; null when there is none.
const Node* Emitter::node_at(std::uint32_t link, std::uint32_t pc) const {
  const auto number = linked(blocks_, link, pc);
  return number == 0 ? nullptr : region_->find(number);
}

/// A block may only begin when none of its instructions can start too late.
void Emitter::check_limit(const Node& node, std::uint32_t stall, const Exit& at_limit) {
  Label leave;
  jump_at_limit(*node.block, stall, leave);
  later([this, &node, stall, at_limit, leave]() mutable {
    L(leave);
    // With a strict limit, a stall asks for a cycle more, so that the next run may have to begin otherwise.
    if (stall == 0 || options_.loose_limit) {
      emit_park(node, at_limit, stall);
    } else {
      emit_leave(at_limit);
    }
  });
}

/// Where the interpreter would begin.
void Emitter::note_place(const Node& node) {
  mov(dword[rbx + static_cast<int>(offsetof(Execution, pc))], node.block->pc);
  mov(dword[rbx + static_cast<int>(offsetof(Execution, next_block))], node.number);
}

/// rcx = where the next core of the round goes on, or 0. The host cannot foresee that jump, and knows of its mistake
/// only when it has this: so it comes first.
void Emitter::load_next_point() {
  if (options_.banks == nullptr) return;  // there are no rounds
  mov(rcx, ptr[rbx + static_cast<int>(offsetof(Execution, host.resume_point_of_next))]);
  mov(rcx, ptr[rcx]);
}

/// Leaves in front of a block so that the next run can begin with it by its resume point. A stall comes with that run.
void Emitter::emit_park(const Node& node, const Exit& exit, std::uint32_t stall) {
  static_assert(sizeof(Pipeline) == sizeof(std::uint64_t));
  load_next_point();
  note_place(node);
  if (exit.straight) {
    mov(rdx, ptr[rbx + static_cast<int>(offsetof(Execution, host.came_from))]);
  } else {
    mov(rdx, bits_of({}));
  }
  mov(ptr[rbx + static_cast<int>(offsetof(Execution, pipeline))], rdx);
  mov(eax, add_exit(exit));
  lea(rdx, ptr[rip + (stall == 0 ? entries_ : stalled_entries_)[index_of(node)]]);
  jmp(park_all_, T_NEAR);
}

/// Likewise at an entry, where no registers are loaded yet. Who came straight has said what the pipeline holds; who
/// came by a jump finds it empty; for who has just begun it is as it was.
void Emitter::emit_park_at_entry(const Node& node, const Exit& exit, std::uint32_t stall) {
  const auto pipeline = ptr[rbx + static_cast<int>(offsetof(Execution, pipeline))];
  load_next_point();
  note_place(node);
  if (exit.is_reached_straight) {
    mov(rdx, ptr[rbx + static_cast<int>(offsetof(Execution, host.came_from))]);
    mov(pipeline, rdx);
  } else {
    Label begun;
    movd(edx, xmm15);
    test(edx, edx);
    jz(begun);
    mov(rdx, bits_of({}));
    mov(pipeline, rdx);
    L(begun);
  }
  mov(eax, add_exit(exit));
  lea(rdx, ptr[rip + (stall == 0 ? entries_ : stalled_entries_)[index_of(node)]]);
  jmp(gates_.park, T_NEAR);
}

/// Behind a jump.
void Emitter::check_limit(const Node& node) {
  Exit exit;
  exit.pc = node.block->pc;
  exit.block = node.number;
  check_limit(node, 0, exit);
  forget_what_came();
}

/// Leaves the block behind `at`, which is counted already but for an unaligned target.
void Emitter::emit_edge(const Instruction* at, std::uint32_t pc, bool jumped) {
  const auto extra = is_branch(at->op) ? kTakenBranchExtra : 0U;
  if (const auto* node = node_at(at->link, pc); node != nullptr) {
    const auto landing = jumped && node->block->unaligned ? kUnalignedTargetExtra : 0U;
    if (is_noted(at, pc)) {
      count(at, extra);
      note_flow_to(at, pc);
      spend(landing);
    } else {
      count(at, extra + landing);
    }
    check_limit(*node);
    if (is_branch(at->op) || node != following_) jmp(label_of(*node), T_NEAR);
    return;
  }
  count(at, extra);
  if (is_noted(at, pc)) note_flow_to(at, pc);
  Exit exit;
  exit.pc = pc;
  exit.at = at;
  exit.jumped = jumped;
  emit_chained_exit(exit);
}

/// Leaves by a patch point.
void Emitter::emit_chained_exit(Exit exit) {
  store_registers();
  // To the next instruction until it is patched. The target stands in data: code is never changed.
  exit.patch_point = exits_.add_patch_point();
  constexpr auto kJumpBytes = 6;
  jmp(ptr[rip + static_cast<int>(exits_.place_of(exit.patch_point) - (getCurr() + kJumpBytes))]);
  exits_.set_unpatched(exit.patch_point, code_memory_.executable(getCurr()));
  mov(eax, add_exit(exit));
  jmp(gates_.leave, T_NEAR);
}

void Emitter::emit_indirect_edge(const Instruction* at) {
  // Where it went last is the best guess.
  if (const auto* node = at->link != 0 ? region_->find(at->link) : nullptr; node != nullptr) {
    Label guessed;
    cmp(eax, node->block->pc);
    je(guessed, T_NEAR);
    aside([this, at, node, guessed]() mutable {
      L(guessed);
      const auto landing = node->block->unaligned ? kUnalignedTargetExtra : 0U;
      if (options_.flow != nullptr) {
        count(at, 0);
        note_flow_to(at, eax);
        spend(landing);
      } else {
        count(at, landing);
      }
      check_limit(*node);
      jmp(label_of(*node), T_NEAR);
    });
  }
  count(at, 0);
  if (options_.flow != nullptr) note_flow_to(at, eax);
  store_registers();
  mov(ptr[rbx + static_cast<int>(offsetof(Execution, pc))], eax);
  Label unknown;
  mov(ecx, eax);
  and_(ecx, TargetTable::kMask);
  mov(rdx, reinterpret_cast<std::uint64_t>(exits_.targets.data()));
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
