// SPDX-License-Identifier: Apache-2.0
//
// Execution and lowering of the operations in isa/rv32f.decode, for F and Zfinx. Register numbers 0 to 31 are integer
// registers (Zfinx), and 32 to 63 are floating-point registers (F).
#include "hart/csr_numbers.hpp"
#include "instructions/float32.hpp"
#include "instructions/load_store.hpp"
#include "instructions/operation.hpp"
#ifdef MEBOTS_TRANSLATES
#include "instructions/lowering.hpp"

#include <xbyak/xbyak_util.h>
#endif

namespace mebots::soc::rv32f {
namespace {

#ifdef MEBOTS_TRANSLATES
using namespace lowering;
#endif
using float32::Context;
using float32::kSign;

const Instruction* illegal(Execution& e, const Instruction* at) {
  return e.raise(at, cause::kIllegalInstruction, e.units->blocks.word_at(at->pc).value_or(0));
}

/// Executes an operation that rounds and raises flags. `compute(context)` must return the value of rd.
template <typename Compute>
const Instruction* run_rounded(Execution& e, const Instruction* at, Compute compute) {
  const auto own = static_cast<unsigned>(at->imm) & 7U;
  const auto mode = own == float32::kDynamic ? e.rounding : own;
  if (e.float_off || mode >= float32::kRoundings) [[unlikely]]
    return illegal(e, at);
  Context context{static_cast<float32::Rounding>(mode)};
  e.x[at->rd] = compute(context);
  e.float_flags |= context.flags;
  return next(e, at);
}

/// Executes an operation that does not round. `compute(context)` must return the value of rd.
template <typename Compute>
const Instruction* run_exact(Execution& e, const Instruction* at, Compute compute) {
  if (e.float_off) [[unlikely]]
    return illegal(e, at);
  Context context;
  e.x[at->rd] = compute(context);
  e.float_flags |= context.flags;
  return next(e, at);
}

// Loads, stores and moves.

template <Op>
const Instruction* execute_float_load(Execution& e, const Instruction* at) {
  if (e.float_off) [[unlikely]]
    return illegal(e, at);
  return load_store::load<std::int32_t, AddressMode::offset>(e, at);
}
template <Op>
const Instruction* execute_float_store(Execution& e, const Instruction* at) {
  if (e.float_off) [[unlikely]]
    return illegal(e, at);
  return load_store::store<std::uint32_t, AddressMode::offset>(e, at);
}
template <Op>
const Instruction* execute_float_move(Execution& e, const Instruction* at) {
  return run_exact(e, at, [&](Context&) { return e.x[at->rs1]; });
}

#ifdef MEBOTS_TRANSLATES
/// Writes code that leaves the block if the floating-point unit is off, or if frm is not the host's rounding mode. Only
/// the first floating-point operation of a block needs this check, because only an instruction that ends a block can
/// change the two.
void emit_check(Assembler& c, const Instruction* at) {
  static_assert(offsetof(Execution, rounding) == offsetof(Execution, float_off) + 1);
  for (const auto* before = at - at->index; before != at; ++before) {
    if (is_float(before->op)) return;
  }
  Label off;
  c.cmp(word[rbx + static_cast<int>(offsetof(Execution, float_off))], 0);
  c.jne(off, kNear);
  c.defer_cold([&c, at, off]() mutable {
    c.L(off);
    c.edges.resume(at);
  });
}
bool emit_float_load(Assembler& c, const Instruction* at) {
  emit_check(c, at);
  return emit_load(c, at);
}
bool emit_float_store(Assembler& c, const Instruction* at) {
  emit_check(c, at);
  return emit_store(c, at);
}
void emit_float_move(Assembler& c, const Instruction* at) {
  emit_check(c, at);
  const auto to = c.registers.place(at->rd, eax);
  c.registers.copy(to, at->rs1);
  c.registers.finish(at->rd, to);
}
#endif

// Arithmetic

#ifdef MEBOTS_TRANSLATES
/// The host executes these operations with rounding to nearest. MXCSR collects their flags: see
/// TranslatedRun::take_float_flags().

/// Writes the checks of an operation that rounds. Returns false if it needs another rounding mode than the host's, so
/// that the interpreter must execute it.
bool emit_rounding(Assembler& c, const Instruction* at) {
  const auto own = static_cast<unsigned>(at->imm) & 7U;
  if (own != static_cast<unsigned>(float32::Rounding::nearest_even) && own != float32::kDynamic) return false;
  emit_check(c, at);
  return true;
}
/// Writes code that stores xmm0 into rd, or the canonical NaN if xmm0 is a NaN.
void finish_float(Assembler& c, const Instruction* at) {
  Label nan;
  Label done;
  c.ucomiss(xmm0, xmm0);
  c.jp(nan, kNear);
  c.L(done);
  c.registers.finish_vector(at->rd, xmm0);
  c.defer_cold([&c, nan, done]() mutable {
    c.L(nan);
    c.mov(eax, float32::kCanonicalNan);
    c.movd(xmm0, eax);
    c.jmp(done, kNear);
  });
}
/// Writes code that copies a register to xmm0, xmm1 or xmm2.
void copy_float(Assembler& c, unsigned reg, const Xmm& to) {
  if (const auto from = c.registers.in_vector_for(reg, to); from.getIdx() != to.getIdx()) c.movaps(to, from);
}
/// Writes code for an arithmetic operation. `apply(to, from)` must write the host instruction for `to = to op from`.
template <typename Apply>
bool emit_arithmetic(Assembler& c, const Instruction* at, Apply apply) {
  if (!emit_rounding(c, at)) return false;
  copy_float(c, at->rs1, xmm0);
  apply(xmm0, c.registers.in_vector_for(at->rs2, xmm1));
  finish_float(c, at);
  return true;
}
bool emit_fadd_s(Assembler& c, const Instruction* at) {
  return emit_arithmetic(c, at, [&](const Xmm& to, const Xmm& from) { c.addss(to, from); });
}
bool emit_fsub_s(Assembler& c, const Instruction* at) {
  return emit_arithmetic(c, at, [&](const Xmm& to, const Xmm& from) { c.subss(to, from); });
}
bool emit_fmul_s(Assembler& c, const Instruction* at) {
  return emit_arithmetic(c, at, [&](const Xmm& to, const Xmm& from) { c.mulss(to, from); });
}
bool emit_fdiv_s(Assembler& c, const Instruction* at) {
  return emit_arithmetic(c, at, [&](const Xmm& to, const Xmm& from) { c.divss(to, from); });
}
bool emit_fsqrt_s(Assembler& c, const Instruction* at) {
  if (!emit_rounding(c, at)) return false;
  copy_float(c, at->rs1, xmm0);
  c.sqrtss(xmm0, xmm0);
  finish_float(c, at);
  return true;
}

/// Writes code for a fused multiply-add. `apply(to, b, c)` must write the host instruction for to = +-to * b +- c.
/// Returns false if the host's processor has no such instruction.
template <typename Apply>
bool emit_multiply_add(Assembler& c, const Instruction* at, Apply apply) {
  if (!translate::host_processor().has(Xbyak::util::Cpu::tFMA) || !emit_rounding(c, at)) return false;
  copy_float(c, at->rs1, xmm0);
  const auto factor = c.registers.in_vector_for(at->rs2, xmm1);
  apply(xmm0, factor, c.registers.in_vector_for(third_register(*at), xmm2));
  // If the result is a NaN, the interpreter computes the flags.
  Label nan;
  c.ucomiss(xmm0, xmm0);
  c.jp(nan, kNear);
  c.registers.finish_vector(at->rd, xmm0);
  c.defer_cold([&c, at, nan]() mutable {
    c.L(nan);
    c.edges.resume(at);
  });
  return true;
}
bool emit_fmadd_s(Assembler& c, const Instruction* at) {
  return emit_multiply_add(c, at, [&](const Xmm& to, const Xmm& by, const Xmm& add) { c.vfmadd213ss(to, by, add); });
}
bool emit_fmsub_s(Assembler& c, const Instruction* at) {
  return emit_multiply_add(c, at, [&](const Xmm& to, const Xmm& by, const Xmm& add) { c.vfmsub213ss(to, by, add); });
}
bool emit_fnmsub_s(Assembler& c, const Instruction* at) {
  return emit_multiply_add(c, at, [&](const Xmm& to, const Xmm& by, const Xmm& add) { c.vfnmadd213ss(to, by, add); });
}
bool emit_fnmadd_s(Assembler& c, const Instruction* at) {
  return emit_multiply_add(c, at, [&](const Xmm& to, const Xmm& by, const Xmm& add) { c.vfnmsub213ss(to, by, add); });
}
#endif

const Instruction* execute_fadd_s(Execution& e, const Instruction* at) {
  return run_rounded(e, at, [&](Context& c) { return float32::add(e.x[at->rs1], e.x[at->rs2], c); });
}
/// Computes a - b as a + -b. A change of the sign does not change whether a NaN is quiet or signalling.
const Instruction* execute_fsub_s(Execution& e, const Instruction* at) {
  return run_rounded(e, at, [&](Context& c) { return float32::add(e.x[at->rs1], e.x[at->rs2] ^ kSign, c); });
}
const Instruction* execute_fmul_s(Execution& e, const Instruction* at) {
  return run_rounded(e, at, [&](Context& c) { return float32::multiply(e.x[at->rs1], e.x[at->rs2], c); });
}
const Instruction* execute_fdiv_s(Execution& e, const Instruction* at) {
  return run_rounded(e, at, [&](Context& c) { return float32::divide(e.x[at->rs1], e.x[at->rs2], c); });
}
const Instruction* execute_fsqrt_s(Execution& e, const Instruction* at) {
  return run_rounded(e, at, [&](Context& c) { return float32::square_root(e.x[at->rs1], c); });
}

/// Computes a * b + c. If set, the sign bits in `product_sign` and `sum_sign` invert the signs of a and c.
const Instruction* run_multiply_add(Execution& e, const Instruction* at, Word product_sign, Word sum_sign) {
  const auto rs3 = third_register(*at);
  return run_rounded(e, at, [&](Context& c) {
    return float32::multiply_add(e.x[at->rs1] ^ product_sign, e.x[at->rs2], e.x[rs3] ^ sum_sign, c);
  });
}
const Instruction* execute_fmadd_s(Execution& e, const Instruction* at) {
  return run_multiply_add(e, at, 0, 0);
}
const Instruction* execute_fmsub_s(Execution& e, const Instruction* at) {
  return run_multiply_add(e, at, 0, kSign);
}
const Instruction* execute_fnmsub_s(Execution& e, const Instruction* at) {
  return run_multiply_add(e, at, kSign, 0);
}
const Instruction* execute_fnmadd_s(Execution& e, const Instruction* at) {
  return run_multiply_add(e, at, kSign, kSign);
}

// Conversions

const Instruction* execute_fcvt_w_s(Execution& e, const Instruction* at) {
  return run_rounded(e, at, [&](Context& c) { return float32::to_signed(e.x[at->rs1], c); });
}
const Instruction* execute_fcvt_wu_s(Execution& e, const Instruction* at) {
  return run_rounded(e, at, [&](Context& c) { return float32::to_unsigned(e.x[at->rs1], c); });
}
const Instruction* execute_fcvt_s_w(Execution& e, const Instruction* at) {
  return run_rounded(e, at, [&](Context& c) { return float32::from_signed(e.x[at->rs1], c); });
}
const Instruction* execute_fcvt_s_wu(Execution& e, const Instruction* at) {
  return run_rounded(e, at, [&](Context& c) { return float32::from_unsigned(e.x[at->rs1], c); });
}

#ifdef MEBOTS_TRANSLATES
/// Writes code that converts a float to an integer in eax. `convert(truncates, leave)` must write the conversion. A
/// jump to `leave` leaves the block.
template <typename Convert>
bool emit_to_integer(Assembler& c, const Instruction* at, Convert convert) {
  const auto own = static_cast<unsigned>(at->imm) & 7U;
  const bool truncates = own == static_cast<unsigned>(float32::Rounding::to_zero);
  if (truncates) {
    emit_check(c, at);
  } else if (!emit_rounding(c, at)) {
    return false;
  }
  Label leave;
  convert(truncates, leave);
  c.registers.finish(at->rd, eax);
  c.defer_cold([&c, at, leave]() mutable {
    c.L(leave);
    c.edges.resume(at);
  });
  return true;
}
bool emit_fcvt_w_s(Assembler& c, const Instruction* at) {
  return emit_to_integer(c, at, [&](bool truncates, const Label& leave) {
    const auto from = c.registers.in_vector_for(at->rs1, xmm0);
    truncates ? c.cvttss2si(eax, from) : c.cvtss2si(eax, from);
    c.cmp(eax, 0x80000000U);  // the host also returns this value if the float is out of range
    c.je(leave, kNear);
  });
}
bool emit_fcvt_wu_s(Assembler& c, const Instruction* at) {
  return emit_to_integer(c, at, [&](bool truncates, const Label& leave) {
    constexpr std::uint32_t kTwoTo32 = 0x4f800000;
    c.registers.copy(eax, at->rs1);
    c.cmp(eax, kTwoTo32);  // as integers, negative values and NaN are also above the limit
    c.jae(leave, kNear);
    const auto from = c.registers.in_vector_for(at->rs1, xmm0);
    truncates ? c.cvttss2si(rax, from) : c.cvtss2si(rax, from);
  });
}
bool emit_fcvt_s_w(Assembler& c, const Instruction* at) {
  if (!emit_rounding(c, at)) return false;
  c.registers.copy(eax, at->rs1);
  c.pxor(xmm0, xmm0);
  c.cvtsi2ss(xmm0, eax);
  c.registers.finish_vector(at->rd, xmm0);
  return true;
}
bool emit_fcvt_s_wu(Assembler& c, const Instruction* at) {
  if (!emit_rounding(c, at)) return false;
  c.registers.copy(eax, at->rs1);
  c.pxor(xmm0, xmm0);
  c.cvtsi2ss(xmm0, rax);
  c.registers.finish_vector(at->rd, xmm0);
  return true;
}
#endif

// Sign injection, comparisons and classes.

const Instruction* execute_fsgnj_s(Execution& e, const Instruction* at) {
  return run_exact(e, at, [&](Context&) { return (e.x[at->rs1] & ~kSign) | (e.x[at->rs2] & kSign); });
}
const Instruction* execute_fsgnjn_s(Execution& e, const Instruction* at) {
  return run_exact(e, at, [&](Context&) { return (e.x[at->rs1] & ~kSign) | (~e.x[at->rs2] & kSign); });
}
const Instruction* execute_fsgnjx_s(Execution& e, const Instruction* at) {
  return run_exact(e, at, [&](Context&) { return e.x[at->rs1] ^ (e.x[at->rs2] & kSign); });
}
const Instruction* execute_fmin_s(Execution& e, const Instruction* at) {
  return run_exact(e, at, [&](Context& c) { return float32::minimum(e.x[at->rs1], e.x[at->rs2], c); });
}
const Instruction* execute_fmax_s(Execution& e, const Instruction* at) {
  return run_exact(e, at, [&](Context& c) { return float32::maximum(e.x[at->rs1], e.x[at->rs2], c); });
}
const Instruction* execute_feq_s(Execution& e, const Instruction* at) {
  return run_exact(e, at, [&](Context& c) { return Word{float32::equal(e.x[at->rs1], e.x[at->rs2], c)}; });
}
const Instruction* execute_flt_s(Execution& e, const Instruction* at) {
  return run_exact(e, at, [&](Context& c) { return Word{float32::less(e.x[at->rs1], e.x[at->rs2], c)}; });
}
const Instruction* execute_fle_s(Execution& e, const Instruction* at) {
  return run_exact(e, at, [&](Context& c) { return Word{float32::less_or_equal(e.x[at->rs1], e.x[at->rs2], c)}; });
}
const Instruction* execute_fclass_s(Execution& e, const Instruction* at) {
  return run_exact(e, at, [&](Context&) { return float32::class_of(e.x[at->rs1]); });
}

#ifdef MEBOTS_TRANSLATES
/// Writes code that puts rs2 into ecx and rs1 into eax, and stores eax into rd after the code that `apply()` writes.
template <typename Apply>
void emit_sign(Assembler& c, const Instruction* at, Apply apply) {
  emit_check(c, at);
  c.registers.copy(ecx, at->rs2);
  c.registers.copy(eax, at->rs1);
  apply();
  c.registers.finish(at->rd, eax);
}
/// Writes code that replaces the sign bit of eax by the sign bit of ecx.
void emit_join_sign(Assembler& c) {
  c.and_(eax, ~kSign);
  c.and_(ecx, kSign);
  c.or_(eax, ecx);
}
void emit_fsgnj_s(Assembler& c, const Instruction* at) {
  emit_sign(c, at, [&] { emit_join_sign(c); });
}
void emit_fsgnjn_s(Assembler& c, const Instruction* at) {
  emit_sign(c, at, [&] {
    c.not_(ecx);
    emit_join_sign(c);
  });
}
void emit_fsgnjx_s(Assembler& c, const Instruction* at) {
  emit_sign(c, at, [&] {
    c.and_(ecx, kSign);
    c.xor_(eax, ecx);
  });
}
/// Writes code for fmin.s or fmax.s. The interpreter handles NaNs and equal values, because two zeros may have
/// different signs.
template <typename Apply>
void emit_extreme(Assembler& c, const Instruction* at, Apply apply) {
  emit_check(c, at);
  copy_float(c, at->rs1, xmm0);
  const auto other = c.registers.in_vector_for(at->rs2, xmm1);
  Label leave;
  c.ucomiss(xmm0, other);
  c.jz(leave, kNear);  // equal or unordered
  apply(xmm0, other);
  c.registers.finish_vector(at->rd, xmm0);
  c.defer_cold([&c, at, leave]() mutable {
    c.L(leave);
    c.edges.resume(at);
  });
}
void emit_fmin_s(Assembler& c, const Instruction* at) {
  emit_extreme(c, at, [&](const Xmm& to, const Xmm& from) { c.minss(to, from); });
}
void emit_fmax_s(Assembler& c, const Instruction* at) {
  emit_extreme(c, at, [&](const Xmm& to, const Xmm& from) { c.maxss(to, from); });
}
void emit_feq_s(Assembler& c, const Instruction* at) {
  emit_check(c, at);
  copy_float(c, at->rs1, xmm0);
  c.ucomiss(xmm0, c.registers.in_vector_for(at->rs2, xmm1));
  c.setnp(cl);
  c.sete(al);
  c.and_(al, cl);
  c.movzx(eax, al);
  c.registers.finish(at->rd, eax);
}
/// Writes code that compares rs2 with rs1. In this order, an unordered result sets the flags of "below".
template <typename Set>
void emit_order(Assembler& c, const Instruction* at, Set set_al) {
  emit_check(c, at);
  copy_float(c, at->rs2, xmm0);
  c.comiss(xmm0, c.registers.in_vector_for(at->rs1, xmm1));
  set_al();
  c.movzx(eax, al);
  c.registers.finish(at->rd, eax);
}
void emit_flt_s(Assembler& c, const Instruction* at) {
  emit_order(c, at, [&] { c.seta(al); });
}
void emit_fle_s(Assembler& c, const Instruction* at) {
  emit_order(c, at, [&] { c.setae(al); });
}
#endif

}  // namespace

constinit const Operation kOperations[] = {
#include "fmu_soc_isa/rv32f.inc"
};

}  // namespace mebots::soc::rv32f
