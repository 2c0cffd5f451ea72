// SPDX-License-Identifier: Apache-2.0
//
// Binds the operations of Xpulp v2 on whole words, its branches and its hardware loops to decoded instructions.
#include "hart/bind.hpp"
#include "hart/hart.hpp"
#include "isa/operations_xpulp.hpp"

namespace mebots::soc {
namespace {

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

const Instruction* loop_start(Execution& e, const Instruction* at) {
  e.loops[at->rs2].start = at->pc + static_cast<Word>(at->imm);
  return next(e, at);
}
const Instruction* loop_set_end(Execution& e, const Instruction* at) {
  return e.hart->set_loop_end(at, at->rs2, at->pc + static_cast<Word>(at->imm));
}
const Instruction* loop_count(Execution& e, const Instruction* at) {
  e.loops[at->rs2].count = e.x[at->rs1];
  return next(e, at);
}
const Instruction* loop_count_immediate(Execution& e, const Instruction* at) {
  e.loops[at->rs2].count = static_cast<Word>(at->imm);
  return next(e, at);
}
const Instruction* loop_setup(Execution& e, const Instruction* at) {
  e.loops[at->rs2].start = at->pc + 4;
  e.loops[at->rs2].count = e.x[at->rs1];
  return e.hart->set_loop_end(at, at->rs2, at->pc + static_cast<Word>(at->imm));
}
const Instruction* loop_setup_immediate(Execution& e, const Instruction* at) {
  const auto fields = static_cast<Word>(at->imm);
  e.loops[at->rs2].start = at->pc + 4;
  e.loops[at->rs2].count = fields & 0xffffU;
  return e.hart->set_loop_end(at, at->rs2, at->pc + (fields >> 16));
}

/// The end of a block whose last instruction may end a loop. The inner loop (0) comes first; a loop with no turn left
/// keeps its count and lets the other one, or what follows, go on. The turn costs nothing.
const Instruction* loop_end(Execution& e, const Instruction* at) {
  const auto last = at[-1].pc;
  e.exit = at;
  for (auto& loop : e.loops) {
    if (loop.end != last || loop.count <= 1) continue;
    --loop.count;
    e.pc = loop.start;
    e.link = e.hart->loop_link(at[1], loop.start);
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

}  // namespace

Handler xpulp_handler_of(Op op, Operand operand) {
  switch (op) {
    case Op::p_beqimm:
      return branch_immediate<true>;
    case Op::p_bneimm:
      return branch_immediate<false>;
    case Op::lp_starti:
      return loop_start;
    case Op::lp_endi:
      return loop_set_end;
    case Op::lp_count:
      return loop_count;
    case Op::lp_counti:
      return loop_count_immediate;
    case Op::lp_setup:
      return loop_setup;
    case Op::lp_setupi:
      return loop_setup_immediate;
    case Op::loop_end:
      return loop_end;
    case Op::p_abs:
      return unary<f::abs>;
    case Op::p_slet:
      return binary<f::slet>;
    case Op::p_sletu:
      return binary<f::sletu>;
    case Op::p_min:
      return binary<f::min>;
    case Op::p_minu:
      return binary<f::minu>;
    case Op::p_max:
      return binary<f::max>;
    case Op::p_maxu:
      return binary<f::maxu>;
    case Op::p_exths:
      return unary<f::exths>;
    case Op::p_exthz:
      return unary<f::exthz>;
    case Op::p_extbs:
      return unary<f::extbs>;
    case Op::p_extbz:
      return unary<f::extbz>;
    case Op::p_clip:
      return either<f::clip>(operand);
    case Op::p_clipu:
      return either<f::clipu>(operand);
    case Op::p_addN:
      return shifted<f::addN>;
    case Op::p_adduN:
      return shifted<f::adduN>;
    case Op::p_addRN:
      return shifted<f::addRN>;
    case Op::p_adduRN:
      return shifted<f::adduRN>;
    case Op::p_subN:
      return shifted<f::subN>;
    case Op::p_subuN:
      return shifted<f::subuN>;
    case Op::p_subRN:
      return shifted<f::subRN>;
    case Op::p_subuRN:
      return shifted<f::subuRN>;
    case Op::p_addNr:
      return accumulate<shift_register<f::addN>>;
    case Op::p_adduNr:
      return accumulate<shift_register<f::adduN>>;
    case Op::p_addRNr:
      return accumulate<shift_register<f::addRN>>;
    case Op::p_adduRNr:
      return accumulate<shift_register<f::adduRN>>;
    case Op::p_subNr:
      return accumulate<shift_register<f::subN>>;
    case Op::p_subuNr:
      return accumulate<shift_register<f::subuN>>;
    case Op::p_subRNr:
      return accumulate<shift_register<f::subRN>>;
    case Op::p_subuRNr:
      return accumulate<shift_register<f::subuRN>>;
    case Op::p_extract:
      return either<f::extract>(operand);
    case Op::p_extractu:
      return either<f::extractu>(operand);
    case Op::p_insert:
      return operand == Operand::immediate ? accumulate<f::insert, Operand::immediate> : accumulate<f::insert>;
    case Op::p_bclr:
      return either<f::bclr>(operand);
    case Op::p_bset:
      return either<f::bset>(operand);
    case Op::p_ff1:
      return unary<f::ff1>;
    case Op::p_fl1:
      return unary<f::fl1>;
    case Op::p_clb:
      return unary<f::clb>;
    case Op::p_cnt:
      return unary<f::cnt>;
    case Op::p_ror:
      return binary<f::ror>;
    case Op::p_mac:
      return accumulate<f::mac>;
    case Op::p_msu:
      return accumulate<f::msu>;
    case Op::p_mulsN:
      return multiply_halves<halves<true, false, false>()>;
    case Op::p_mulhhsN:
      return multiply_halves<halves<true, true, false>()>;
    case Op::p_mulsRN:
      return multiply_halves<halves<true, false, true>()>;
    case Op::p_mulhhsRN:
      return multiply_halves<halves<true, true, true>()>;
    case Op::p_muluN:
      return multiply_halves<halves<false, false, false>()>;
    case Op::p_mulhhuN:
      return multiply_halves<halves<false, true, false>()>;
    case Op::p_muluRN:
      return multiply_halves<halves<false, false, true>()>;
    case Op::p_mulhhuRN:
      return multiply_halves<halves<false, true, true>()>;
    case Op::p_macsN:
      return accumulate_halves<halves<true, false, false>()>;
    case Op::p_machhsN:
      return accumulate_halves<halves<true, true, false>()>;
    case Op::p_macsRN:
      return accumulate_halves<halves<true, false, true>()>;
    case Op::p_machhsRN:
      return accumulate_halves<halves<true, true, true>()>;
    case Op::p_macuN:
      return accumulate_halves<halves<false, false, false>()>;
    case Op::p_machhuN:
      return accumulate_halves<halves<false, true, false>()>;
    case Op::p_macuRN:
      return accumulate_halves<halves<false, false, true>()>;
    case Op::p_machhuRN:
      return accumulate_halves<halves<false, true, true>()>;
    default:
      return nullptr;
  }
}

}  // namespace mebots::soc
