// SPDX-License-Identifier: Apache-2.0
//
// Execution and lowering of the operations in isa/xpulp.decode (Xpulp v2 on whole words). The manual does not define
// some results: sums that wrap, bit fields that exceed the word, negative bounds of a clip. These results are the same
// as in RI5CY's RTL (pulp-platform/riscv, February 2018).
#include "hart/block_cache.hpp"

#include "instructions/load_store.hpp"
#include "instructions/operation.hpp"
#include "mebots/assert.hpp"
#ifdef MEBOTS_TRANSLATES
#include "instructions/lowering.hpp"

#include <optional>
#endif

#include <bit>

namespace mebots::soc::xpulp {
namespace {

#ifdef MEBOTS_TRANSLATES
using namespace lowering;
#endif

constexpr Word shift_right_signed(Word a, Word places) {
  return static_cast<Word>(as_signed(a) >> (places & 31U));
}

// Branches that compare with a signed 5-bit immediate.

constexpr bool execute_p_beqimm(Word a, Word b) {
  return a == b;
}
constexpr bool execute_p_bneimm(Word a, Word b) {
  return a != b;
}

#ifdef MEBOTS_TRANSLATES
template <typename Jump>
void emit_branch_immediate(Assembler& c, const Instruction* at, Jump jump) {
  const auto with = static_cast<std::int32_t>(std::uint32_t{at->rs2} << 27) >> 27;
  c.cmp(c.registers.value(at->rs1, eax), static_cast<std::uint32_t>(with));
  c.edges.branch(at, jump);
}
void emit_p_beqimm(Assembler& c, const Instruction* at) {
  emit_branch_immediate(c, at, [&](const Label& taken) { c.je(taken, kNear); });
}
void emit_p_bneimm(Assembler& c, const Instruction* at) {
  emit_branch_immediate(c, at, [&](const Label& taken) { c.jne(taken, kNear); });
}
#endif

// Loads: instructions/load_store.hpp executes them, except for p.elw.

const Instruction* execute_p_elw(Execution& e, const Instruction* at) {
  return e.units->data_path.event_load(at);
}

// Hardware loops. rs2 is the number of the loop.

const Instruction* execute_lp_starti(Execution& e, const Instruction* at) {
  MEBOTS_ASSERT(at->rs2 < e.loops.size());
  e.loops[at->rs2].start = at->pc + static_cast<Word>(at->imm);
  return next(e, at);
}
/// Sets the end of a loop. If blocks did not end there before, leaves the block, because it may have to be decoded
/// again.
const Instruction* set_loop_end(Execution& e, const Instruction* at, Word pc) {
  MEBOTS_ASSERT(at->rs2 < e.loops.size());
  e.loops[at->rs2].end = pc;
  return e.units->blocks.end_block_at(pc) ? e.leave_after(at, Leave::normal) : next(e, at);
}
const Instruction* execute_lp_endi(Execution& e, const Instruction* at) {
  return set_loop_end(e, at, at->pc + static_cast<Word>(at->imm));
}
const Instruction* execute_lp_count(Execution& e, const Instruction* at) {
  MEBOTS_ASSERT(at->rs2 < e.loops.size());
  e.loops[at->rs2].count = e.x[at->rs1];
  return next(e, at);
}
const Instruction* execute_lp_counti(Execution& e, const Instruction* at) {
  e.loops[at->rs2].count = static_cast<Word>(at->imm);
  return next(e, at);
}
const Instruction* execute_lp_setup(Execution& e, const Instruction* at) {
  e.loops[at->rs2].start = at->pc + 4;
  e.loops[at->rs2].count = e.x[at->rs1];
  return set_loop_end(e, at, at->pc + static_cast<Word>(at->imm));
}
/// The lower half of the immediate is the count, and the upper half is the distance to the loop's end.
const Instruction* execute_lp_setupi(Execution& e, const Instruction* at) {
  const auto fields = static_cast<Word>(at->imm);
  e.loops[at->rs2].start = at->pc + 4;
  e.loops[at->rs2].count = fields & 0xffffU;
  return set_loop_end(e, at, at->pc + (fields >> 16));
}
/// Executes the end of a block whose last instruction may end a loop. Checks the inner loop (0) first, and then the
/// outer loop. If neither loop has a further iteration, execution continues after the block. The jump to the start of a
/// loop takes no cycle.
const Instruction* execute_loop_end(Execution& e, const Instruction* at) {
  MEBOTS_ASSERT(at->index > 0 && is_block_end(at->op));
  const auto last = at[-1].pc;
  e.exit = at;
  for (auto& loop : e.loops) {
    if (loop.end != last || loop.count <= 1) continue;
    --loop.count;
    e.pc = loop.start;
    e.link = e.units->blocks.loop_link(at[1], loop.start);
    return nullptr;
  }
  e.pc = at->pc;
  e.link = &at->link;
  return nullptr;
}

#ifdef MEBOTS_TRANSLATES
/// Returns the host's memory operand for a field of the hardware loop. `offset` is the offset of the field in
/// HardwareLoop.
Xbyak::Address loop_register(const Instruction* at, std::size_t offset) {
  MEBOTS_ASSERT(is_hardware_loop(at->op) && at->rs2 < 2);
  return dword[rbx + translate::offset_of_loop(at->rs2) + static_cast<int>(offset)];
}
/// Returns false if blocks do not end at `pc` yet. The interpreter must then execute the instruction and end blocks
/// there.
bool emit_set_loop_end(Assembler& c, const Instruction* at, std::uint32_t pc) {
  if (!c.blocks.may_end_loop(pc)) return false;
  c.mov(loop_register(at, offsetof(HardwareLoop, end)), pc);
  return true;
}
void emit_lp_starti(Assembler& c, const Instruction* at) {
  c.mov(loop_register(at, offsetof(HardwareLoop, start)), at->pc + static_cast<std::uint32_t>(at->imm));
}
bool emit_lp_endi(Assembler& c, const Instruction* at) {
  return emit_set_loop_end(c, at, at->pc + static_cast<std::uint32_t>(at->imm));
}
void emit_lp_count(Assembler& c, const Instruction* at) {
  c.mov(loop_register(at, offsetof(HardwareLoop, count)), c.registers.value(at->rs1, eax));
}
void emit_lp_counti(Assembler& c, const Instruction* at) {
  c.mov(loop_register(at, offsetof(HardwareLoop, count)), static_cast<std::uint32_t>(at->imm));
}
bool emit_lp_setup(Assembler& c, const Instruction* at) {
  if (!emit_set_loop_end(c, at, at->pc + static_cast<std::uint32_t>(at->imm))) return false;
  c.mov(loop_register(at, offsetof(HardwareLoop, start)), at->pc + 4);
  emit_lp_count(c, at);
  return true;
}
bool emit_lp_setupi(Assembler& c, const Instruction* at) {
  const auto imm = static_cast<std::uint32_t>(at->imm);
  if (!emit_set_loop_end(c, at, at->pc + (imm >> 16))) return false;
  c.mov(loop_register(at, offsetof(HardwareLoop, start)), at->pc + 4);
  c.mov(loop_register(at, offsetof(HardwareLoop, count)), imm & 0xffffU);
  return true;
}
void emit_loop_end(Assembler& c, const Instruction* at) {
  for (unsigned loop = 0; loop < 2; ++loop) {
    const auto count = dword[rbx + translate::offset_of_loop(loop) + static_cast<int>(offsetof(HardwareLoop, count))];
    Label other;
    c.cmp(dword[rbx + translate::offset_of_loop(loop) + static_cast<int>(offsetof(HardwareLoop, end))], at[-1].pc);
    c.jne(other, kNear);
    c.cmp(count, 1);
    c.jbe(other, kNear);
    c.dec(count);
    c.edges.iterate(at, loop);
    c.L(other);
  }
  c.edges.fall_through(at, at->link, at->pc, true);
}
#endif

// General ALU

constexpr Word execute_p_abs(Word a) {
  return as_signed(a) < 0 ? Word{0} - a : a;  // -2^31 stays the same
}
constexpr Word execute_p_slet(Word a, Word b) {
  return as_signed(a) <= as_signed(b) ? 1U : 0U;
}
constexpr Word execute_p_sletu(Word a, Word b) {
  return a <= b ? 1U : 0U;
}
constexpr Word execute_p_min(Word a, Word b) {
  return as_signed(a) < as_signed(b) ? a : b;
}
constexpr Word execute_p_minu(Word a, Word b) {
  return a < b ? a : b;
}
constexpr Word execute_p_max(Word a, Word b) {
  return as_signed(a) > as_signed(b) ? a : b;
}
constexpr Word execute_p_maxu(Word a, Word b) {
  return a > b ? a : b;
}
constexpr Word execute_p_exths(Word a) {
  return static_cast<Word>(static_cast<std::int16_t>(a));
}
constexpr Word execute_p_exthz(Word a) {
  return a & 0xffffU;
}
constexpr Word execute_p_extbs(Word a) {
  return static_cast<Word>(static_cast<std::int8_t>(a));
}
constexpr Word execute_p_extbz(Word a) {
  return a & 0xffU;
}
/// Limits a value to [-bound - 1, bound].
constexpr Word execute_p_clip(Word a, Word bound) {
  if (as_signed(a) > as_signed(bound)) return bound;
  return std::int64_t{as_signed(a)} + as_signed(bound) + 1 < 0 ? ~bound : a;
}
/// Limits a value to [0, bound].
constexpr Word execute_p_clipu(Word a, Word bound) {
  if (as_signed(a) > as_signed(bound)) return bound;
  return as_signed(a) < 0 ? 0U : a;
}

#ifdef MEBOTS_TRANSLATES
void emit_p_abs(Assembler& c, const Instruction* at) {
  c.registers.copy(eax, at->rs1);
  c.mov(ecx, eax);
  c.neg(eax);
  c.cmovs(eax, ecx);
  c.registers.finish(at->rd, eax);
}
void emit_p_slet(Assembler& c, const Instruction* at) {
  emit_set(c, at, [&] { c.setle(al); });
}
void emit_p_sletu(Assembler& c, const Instruction* at) {
  emit_set(c, at, [&] { c.setbe(al); });
}
/// Writes code that selects one of two operands by the flags of their difference. `move()` must write the cmov that
/// copies the second operand from ecx to eax.
template <typename Move>
void emit_select(Assembler& c, const Instruction* at, Move move) {
  c.registers.copy(eax, at->rs1);
  c.registers.copy(ecx, at->rs2);
  c.cmp(eax, ecx);
  move();
  c.registers.finish(at->rd, eax);
}
void emit_p_min(Assembler& c, const Instruction* at) {
  emit_select(c, at, [&] { c.cmovg(eax, ecx); });
}
void emit_p_minu(Assembler& c, const Instruction* at) {
  emit_select(c, at, [&] { c.cmova(eax, ecx); });
}
void emit_p_max(Assembler& c, const Instruction* at) {
  emit_select(c, at, [&] { c.cmovl(eax, ecx); });
}
void emit_p_maxu(Assembler& c, const Instruction* at) {
  emit_select(c, at, [&] { c.cmovb(eax, ecx); });
}
void emit_p_exths(Assembler& c, const Instruction* at) {
  emit_unary(c, at, [&](const Reg32& to) { c.movsx(to, ax); });
}
void emit_p_exthz(Assembler& c, const Instruction* at) {
  emit_unary(c, at, [&](const Reg32& to) { c.movzx(to, ax); });
}
void emit_p_extbs(Assembler& c, const Instruction* at) {
  emit_unary(c, at, [&](const Reg32& to) { c.movsx(to, al); });
}
void emit_p_extbz(Assembler& c, const Instruction* at) {
  emit_unary(c, at, [&](const Reg32& to) { c.movzx(to, al); });
}
/// Writes code that limits a value. The lower bound is 0 for an unsigned clip, and the complement of the upper bound
/// for a signed clip.
void emit_clip(Assembler& c, const Instruction* at, bool is_signed) {
  c.registers.copy(eax, at->rs1);
  if (operand_of(*at) == Operand::immediate) {
    c.mov(ecx, static_cast<std::uint32_t>(at->imm));
  } else {
    c.registers.copy(ecx, at->rs2);
  }
  if (is_signed) {
    c.mov(edx, ecx);
    c.not_(edx);
    c.cmp(eax, edx);
    c.cmovge(edx, eax);
  } else {
    c.xor_(edx, edx);
    c.test(eax, eax);
    c.cmovns(edx, eax);
  }
  c.cmp(eax, ecx);  // the upper bound has priority over the lower bound
  c.cmovg(edx, ecx);
  c.registers.finish(at->rd, edx);
}
void emit_p_clip(Assembler& c, const Instruction* at) {
  emit_clip(c, at, true);
}
void emit_p_clipu(Assembler& c, const Instruction* at) {
  emit_clip(c, at, false);
}
#endif

// Sums that are shifted right. Their traits state whether they subtract, round, and extend the sign.

/// Returns the value that rounds a sum before the shift: half of the lowest bit that remains after the shift.
constexpr Word rounding(Word shift) {
  return (Word{1} << shift) >> 1;
}
/// Shifts to the right, arithmetically if the operation is signed.
template <Op kOp>
constexpr Word shift_right(Word a, Word places) {
  return traits_of(kOp).sign ? shift_right_signed(a, places) : a >> (places & 31U);
}
template <Op kOp>
constexpr Word execute_shifted_sum(Word a, Word b, Word shift) {
  const Word sum = traits_of(kOp).subtracts ? a - b : a + b;
  return shift_right<kOp>(traits_of(kOp).rounds ? sum + rounding(shift) : sum, shift);
}
/// Shifts the sum or difference of rd and rs1 right by the low five bits of rs2.
template <Op kOp>
constexpr Word execute_shifted_sum_by_register(Word a, Word b, Word shift) {
  return execute_shifted_sum<kOp>(a, b, shift & 31U);
}

#ifdef MEBOTS_TRANSLATES
/// Writes code that computes the sum or difference of two registers in eax. The code changes ecx.
void emit_sum(Assembler& c, const Instruction* at, unsigned a, unsigned b) {
  c.registers.copy(eax, a);
  c.registers.copy(ecx, b);
  traits_of(at->op).subtracts ? c.sub(eax, ecx) : c.add(eax, ecx);
}
void emit_shifted_sum(Assembler& c, const Instruction* at) {
  const auto& traits = traits_of(at->op);
  const auto shift = static_cast<unsigned>(at->imm) & 31U;
  emit_sum(c, at, at->rs1, at->rs2);
  if (traits.rounds) c.add(eax, (1U << shift) >> 1);
  traits.sign ? c.sar(eax, static_cast<int>(shift)) : c.shr(eax, static_cast<int>(shift));
  c.registers.finish(at->rd, eax);
}
void emit_shifted_sum_by_register(Assembler& c, const Instruction* at) {
  const auto& traits = traits_of(at->op);
  emit_sum(c, at, at->rd, at->rs1);
  c.registers.copy(ecx, at->rs2);
  if (traits.rounds) {
    c.mov(edx, 1);
    c.shlx(edx, edx, ecx);
    c.shr(edx, 1);
    c.add(eax, edx);
  }
  traits.sign ? c.sarx(eax, eax, ecx) : c.shrx(eax, eax, ecx);
  c.registers.finish(at->rd, eax);
}
#endif

// Operations on bit fields. An immediate or a register describes a bit field as `(width - 1) << 5 | position`.

/// Returns the mask of a bit field, moved to position 0.
constexpr Word field_mask(Word bits) {
  return ~(0xfffffffeU << (bits >> 5 & 31U));
}
constexpr Word execute_p_extractu(Word a, Word bits) {
  return (a >> (bits & 31U)) & field_mask(bits);
}
/// Returns a bit field of `a` with sign extension. Bits of the field beyond the end of the word are copies of the sign
/// bit.
constexpr Word execute_p_extract(Word a, Word bits) {
  const auto shifted = shift_right_signed(a, bits);
  const auto mask = field_mask(bits);
  return (shifted >> (bits >> 5 & 31U) & 1U) != 0 ? shifted | ~mask : shifted & mask;
}
/// Returns `into` with the bit field replaced by the low bits of `a`.
constexpr Word execute_p_insert(Word into, Word a, Word bits) {
  const auto mask = field_mask(bits) << (bits & 31U);
  return (into & ~mask) | ((a << (bits & 31U)) & mask);
}
constexpr Word execute_p_bclr(Word a, Word bits) {
  return a & ~(field_mask(bits) << (bits & 31U));
}
constexpr Word execute_p_bset(Word a, Word bits) {
  return a | (field_mask(bits) << (bits & 31U));
}
/// Returns the position of the lowest set bit, or 32 if no bit is set.
constexpr Word execute_p_ff1(Word a) {
  return static_cast<Word>(std::countr_zero(a));
}
/// Returns the position of the highest set bit, or 32 if no bit is set.
constexpr Word execute_p_fl1(Word a) {
  return a == 0 ? 32U : 31U - static_cast<Word>(std::countl_zero(a));
}
/// Returns the number of consecutive bits after the sign bit that are equal to it. Returns 0 for the word 0.
constexpr Word execute_p_clb(Word a) {
  if (a == 0) return 0;
  return static_cast<Word>(as_signed(a) < 0 ? std::countl_one(a) : std::countl_zero(a)) - 1U;
}
constexpr Word execute_p_cnt(Word a) {
  return static_cast<Word>(std::popcount(a));
}
constexpr Word execute_p_ror(Word a, Word b) {
  return std::rotr(a, static_cast<int>(b & 31U));
}

#ifdef MEBOTS_TRANSLATES
struct Field {
  unsigned position = 0;
  unsigned width = 0;
  std::uint32_t low = 0;   // mask of the field, moved to position 0
  std::uint32_t mask = 0;  // mask of the field
};
/// Returns the bit field that the immediate describes, without bits beyond the end of the word. Returns nullopt if a
/// register describes the field, which is rare.
std::optional<Field> field_of(const Instruction* at) {
  if (operand_of(*at) != Operand::immediate) return std::nullopt;
  const auto imm = static_cast<unsigned>(at->imm);
  Field field{.position = imm & 31U, .width = (imm >> 5 & 31U) + 1};
  field.low = field.width == 32 ? ~0U : (1U << field.width) - 1U;
  field.mask = field.low << field.position;
  return field;
}
bool emit_extract_field(Assembler& c, const Instruction* at, bool sign) {
  const auto field = field_of(at);
  if (!field) return false;
  c.registers.copy(eax, at->rs1);
  if (sign) {
    const auto unused = static_cast<int>(32 - field->width);
    c.sar(eax, static_cast<int>(field->position));
    c.shl(eax, unused);
    c.sar(eax, unused);
  } else {
    c.shr(eax, static_cast<int>(field->position));
    c.and_(eax, field->low);
  }
  c.registers.finish(at->rd, eax);
  return true;
}
bool emit_p_extract(Assembler& c, const Instruction* at) {
  return emit_extract_field(c, at, true);
}
bool emit_p_extractu(Assembler& c, const Instruction* at) {
  return emit_extract_field(c, at, false);
}
bool emit_p_insert(Assembler& c, const Instruction* at) {
  const auto field = field_of(at);
  if (!field) return false;
  c.registers.copy(eax, at->rs1);
  c.shl(eax, static_cast<int>(field->position));
  c.and_(eax, field->mask);
  c.registers.copy(ecx, at->rd);
  c.and_(ecx, ~field->mask);
  c.or_(eax, ecx);
  c.registers.finish(at->rd, eax);
  return true;
}
bool emit_p_bclr(Assembler& c, const Instruction* at) {
  const auto field = field_of(at);
  if (!field) return false;
  c.registers.copy(eax, at->rs1);
  c.and_(eax, ~field->mask);
  c.registers.finish(at->rd, eax);
  return true;
}
bool emit_p_bset(Assembler& c, const Instruction* at) {
  const auto field = field_of(at);
  if (!field) return false;
  c.registers.copy(eax, at->rs1);
  c.or_(eax, field->mask);
  c.registers.finish(at->rd, eax);
  return true;
}
void emit_p_ff1(Assembler& c, const Instruction* at) {
  emit_unary(c, at, [&](const Reg32& to) { c.tzcnt(to, to); });
}
void emit_p_fl1(Assembler& c, const Instruction* at) {
  c.registers.copy(eax, at->rs1);
  c.lzcnt(eax, eax);  // the result for 0 is also 32
  c.mov(ecx, 31);
  c.sub(ecx, eax);
  c.cmovns(eax, ecx);
  c.registers.finish(at->rd, eax);
}
void emit_p_cnt(Assembler& c, const Instruction* at) {
  emit_unary(c, at, [&](const Reg32& to) { c.popcnt(to, to); });
}
void emit_p_ror(Assembler& c, const Instruction* at) {
  c.registers.copy(eax, at->rs1);
  copy_second(c, at, ecx);
  c.ror(eax, cl);
  c.registers.finish(at->rd, eax);
}
#endif

// Multiplications and accumulations.

constexpr Word execute_p_mac(Word sum, Word a, Word b) {
  return sum + a * b;
}
constexpr Word execute_p_msu(Word sum, Word a, Word b) {
  return sum - a * b;
}
/// Returns the upper or the lower half of a word, depending on the operation, extended to a word.
template <Op kOp>
constexpr Word half(Word a) {
  if (traits_of(kOp).high) return shift_right<kOp>(a, 16);
  return traits_of(kOp).sign ? static_cast<Word>(static_cast<std::int16_t>(a)) : a & 0xffffU;
}
/// Returns `sum` plus the product of two halves, shifted right. Rounds before the shift if the operation rounds.
template <Op kOp>
constexpr Word execute_accumulate_halves(Word sum, Word a, Word b, Word shift) {
  sum += half<kOp>(a) * half<kOp>(b);
  return shift_right<kOp>(traits_of(kOp).rounds ? sum + rounding(shift) : sum, shift);
}
template <Op kOp>
constexpr Word execute_multiply_halves(Word a, Word b, Word shift) {
  return execute_accumulate_halves<kOp>(0, a, b, shift);
}

#ifdef MEBOTS_TRANSLATES
void emit_multiply_accumulate(Assembler& c, const Instruction* at, bool subtracts) {
  c.registers.copy(eax, at->rs1);
  c.registers.copy(ecx, at->rs2);
  c.imul(eax, ecx);
  if (c.registers.in_vector(at->rd)) {
    c.movd(xmm0, eax);
    subtracts ? c.psubd(c.registers.vector(at->rd), xmm0) : c.paddd(c.registers.vector(at->rd), xmm0);
  } else if (subtracts) {
    c.sub(c.registers.operand(at->rd), eax);
  } else {
    c.add(c.registers.operand(at->rd), eax);
  }
}
void emit_p_mac(Assembler& c, const Instruction* at) {
  emit_multiply_accumulate(c, at, false);
}
void emit_p_msu(Assembler& c, const Instruction* at) {
  emit_multiply_accumulate(c, at, true);
}
void emit_multiply_halves(Assembler& c, const Instruction* at) {
  const auto& traits = traits_of(at->op);
  const auto shift = static_cast<unsigned>(at->imm) & 31U;
  const auto take_half = [&](const Reg32& to, unsigned reg) {
    c.registers.copy(to, reg);
    if (traits.high) {
      traits.sign ? c.sar(to, 16) : c.shr(to, 16);
    } else {
      traits.sign ? c.movsx(to, to.cvt16()) : c.movzx(to, to.cvt16());
    }
  };
  take_half(eax, at->rs1);
  take_half(ecx, at->rs2);
  c.imul(eax, ecx);
  if (traits.reads_rd) c.add(eax, c.registers.source(at->rd, ecx));
  if (traits.rounds) c.add(eax, (1U << shift) >> 1);
  traits.sign ? c.sar(eax, static_cast<int>(shift)) : c.shr(eax, static_cast<int>(shift));
  c.registers.finish(at->rd, eax);
}
void emit_accumulate_halves(Assembler& c, const Instruction* at) {
  emit_multiply_halves(c, at);
}
#endif

}  // namespace

constinit const Operation kOperations[] = {
#include "fmu_soc_isa/xpulp.inc"
};

}  // namespace mebots::soc::xpulp
