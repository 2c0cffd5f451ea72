// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/bind.hpp"
#include "hart/block_cache.hpp"
#include "hart/rooms.hpp"
#include "isa/operations_xpulp.hpp"

/// Handlers of Xpulp v2 on whole words, of its branches and of its hardware loops.
namespace mebots::soc::meaning {

namespace f = operations;
using Word = std::uint32_t;

/// rd = compute(rs1, rs2, shift)
template <auto Compute>
const Instruction* shifted(Execution& e, const Instruction* at) {
  e.x[at->rd] = Compute(e.x[at->rs1], e.x[at->rs2], static_cast<Word>(at->imm));
  return next(e, at);
}

/// The forms with a shift in a register take the low five bits.
template <auto Compute>
constexpr Word shift_register(Word a, Word b, Word shift) {
  return Compute(a, b, shift & 31U);
}

template <auto Compute>
const Instruction* multiply_halves(Execution& e, const Instruction* at) {
  e.x[at->rd] = Compute(0, e.x[at->rs1], e.x[at->rs2], static_cast<Word>(at->imm));
  return next(e, at);
}
template <auto Compute>
const Instruction* accumulate_halves(Execution& e, const Instruction* at) {
  e.x[at->rd] = Compute(e.x[at->rd], e.x[at->rs1], e.x[at->rs2], static_cast<Word>(at->imm));
  return next(e, at);
}

/// p.beqimm, p.bneimm
template <bool kEqual>
const Instruction* branch_immediate(Execution& e, const Instruction* at) {
  const auto value = static_cast<Word>(static_cast<std::int32_t>(Word{at->rs2} << 27) >> 27);
  return (e.x[at->rs1] == value) == kEqual ? take_branch(e, at) : next(e, at);
}

// Hardware loops. Number of the loop: rs2.

inline const Instruction* loop_start(Execution& e, const Instruction* at) {
  e.loops[at->rs2].start = at->pc + static_cast<Word>(at->imm);
  return next(e, at);
}
/// A block in progress that would go on behind the new end is left: it does not stand for its code any more.
inline const Instruction* set_loop_end(Execution& e, const Instruction* at, Word pc) {
  e.loops[at->rs2].end = pc;
  return e.rooms->blocks.end_block_at(pc) ? e.leave_after(at, Leave::normal) : next(e, at);
}
inline const Instruction* loop_set_end(Execution& e, const Instruction* at) {
  return set_loop_end(e, at, at->pc + static_cast<Word>(at->imm));
}
inline const Instruction* loop_count(Execution& e, const Instruction* at) {
  e.loops[at->rs2].count = e.x[at->rs1];
  return next(e, at);
}
inline const Instruction* loop_count_immediate(Execution& e, const Instruction* at) {
  e.loops[at->rs2].count = static_cast<Word>(at->imm);
  return next(e, at);
}
inline const Instruction* loop_setup(Execution& e, const Instruction* at) {
  e.loops[at->rs2].start = at->pc + 4;
  e.loops[at->rs2].count = e.x[at->rs1];
  return set_loop_end(e, at, at->pc + static_cast<Word>(at->imm));
}
inline const Instruction* loop_setup_immediate(Execution& e, const Instruction* at) {
  const auto fields = static_cast<Word>(at->imm);
  e.loops[at->rs2].start = at->pc + 4;
  e.loops[at->rs2].count = fields & 0xffffU;
  return set_loop_end(e, at, at->pc + (fields >> 16));
}

/// The end of a block whose last instruction may end a loop. The inner loop (0) comes first; a loop with no turn left
/// keeps its count and lets the other one, or what follows, go on. The turn costs nothing.
inline const Instruction* loop_end(Execution& e, const Instruction* at) {
  const auto last = at[-1].pc;
  e.exit = at;
  for (auto& loop : e.loops) {
    if (loop.end != last || loop.count <= 1) continue;
    --loop.count;
    e.pc = loop.start;
    e.link = e.rooms->blocks.loop_link(at[1], loop.start);
    return nullptr;
  }
  e.pc = at->pc;
  e.link = &at->link;
  return nullptr;
}

template <bool kSigned, bool kHigh, bool kRounds>
constexpr auto halves() {
  constexpr auto kHalf =
      kSigned ? (kHigh ? f::high_signed : f::low_signed) : (kHigh ? f::high_unsigned : f::low_unsigned);
  return f::multiply_halves < kHalf, kSigned ? f::sra : f::srl, kRounds > ;
}

}  // namespace mebots::soc::meaning
