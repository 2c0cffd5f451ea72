// SPDX-License-Identifier: Apache-2.0
//
// Binds the operations of Xpulp v2 to decoded instructions.
#include "hart/handler.hpp"
#include "hart/hart.hpp"
#include "hart/ram_access.hpp"
#include "isa/operations_simd.hpp"
#include "isa/operations_xpulp.hpp"

#include <cstring>
#include <type_traits>

namespace mebots::soc {
namespace {

namespace f = operations;
using Word = std::uint32_t;

/// The second operand of an instruction, from where its form has it.
template <Operand kFrom, typename T = std::int32_t>
[[gnu::always_inline]] inline Word second(const Execution& e, const Instruction* at) {
  if constexpr (kFrom == Operand::immediate) return static_cast<Word>(at->imm);
  if constexpr (kFrom == Operand::scalar) return f::in_all_parts<T>(e.x[at->rs2]);
  return e.x[at->rs2];
}

template <auto Compute>
const Instruction* unary(Execution& e, const Instruction* at) {
  e.x[at->rd] = Compute(e.x[at->rs1]);
  return next(e, at);
}

/// T is the type of a part, which a scalar operand is copied into.
template <auto Compute, Operand kFrom, typename T = std::int32_t>
const Instruction* binary(Execution& e, const Instruction* at) {
  e.x[at->rd] = Compute(e.x[at->rs1], second<kFrom, T>(e, at));
  return next(e, at);
}

/// Also reads rd. (For rd = x0 that is something else, but so is what it writes.)
template <auto Compute, Operand kFrom, typename T = std::int32_t>
const Instruction* accumulate(Execution& e, const Instruction* at) {
  e.x[at->rd] = Compute(e.x[at->rd], e.x[at->rs1], second<kFrom, T>(e, at));
  return next(e, at);
}

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
  if ((e.x[at->rs1] == value) == kEqual) {
    e.pc = static_cast<Word>(at->imm);
    e.extra_cycles += kTakenBranchExtra;
    e.jumped = true;
    e.redirected = true;
    e.exit = at + 1;
    e.link = &at->link;
    return nullptr;
  }
  return next(e, at);
}

enum class Mode : std::uint8_t { offset_register, post_immediate, post_register };

/// After the slow way: whether the access took place, or is a trap or for another time.
bool retired(const Execution& e, const Instruction* at) {
  return e.exit == at + 1;
}

/// Writes back an address register; x0 stays 0.
[[gnu::always_inline]] inline void increment(Execution& e, const Instruction* at, Word value) {
  e.x[at->rs1] = value;
  e.x[0] = 0;
}

template <typename T, Mode kMode>
const Instruction* load(Execution& e, const Instruction* at) {
  const auto base = e.x[at->rs1];
  const auto step = kMode == Mode::post_immediate ? static_cast<Word>(at->imm) : e.x[at->rs2];
  const auto address = kMode == Mode::offset_register ? base + step : base;
  const auto ram = ram_access<sizeof(T)>(e, at, address);
  if (ram.data == nullptr) [[unlikely]] {
    const auto* left = e.hart->slow_load(at, address, sizeof(T), std::is_signed_v<T>);
    if (kMode != Mode::offset_register && retired(e, at) && at->rd != at->rs1) increment(e, at, base + step);
    return left;
  }
  T value;
  std::memcpy(&value, ram.data, sizeof value);
  if constexpr (kMode != Mode::offset_register) increment(e, at, base + step);
  e.x[at->rd] = static_cast<Word>(static_cast<std::int32_t>(value));  // after the increment: the load wins
  if constexpr (sizeof(T) > 1) {
    if (crosses_word(address, sizeof(T))) [[unlikely]]
      misaligned_load(e, at);
  }
  return next(e, at);
}

/// The register of an offset or increment stands in imm.
template <typename T, Mode kMode>
const Instruction* store(Execution& e, const Instruction* at) {
  const auto base = e.x[at->rs1];
  const auto step = kMode == Mode::post_immediate ? static_cast<Word>(at->imm) : e.x[static_cast<Word>(at->imm)];
  const auto address = kMode == Mode::offset_register ? base + step : base;
  const auto word = e.x[at->rs2];
  const auto ram = ram_access<sizeof(T)>(e, at, address);
  if (ram.data == nullptr) [[unlikely]] {
    const auto* left = e.hart->slow_store(at, address, sizeof(T), word);
    if (kMode != Mode::offset_register && retired(e, at)) increment(e, at, base + step);
    return left;
  }
  const auto value = static_cast<T>(word);
  std::memcpy(ram.data, &value, sizeof value);
  if constexpr (kMode != Mode::offset_register) increment(e, at, base + step);
  std::uint8_t marks = ram.marks[0];
  if constexpr (sizeof(T) > 1) {
    if (crosses_word(address, sizeof(T))) [[unlikely]] {
      e.extra_cycles += kMisalignedExtra;
      marks |= ram.marks[1];
    }
  }
  if (marks != 0) [[unlikely]]
    return e.hart->marked_store(at, address, sizeof(T));
  return next(e, at);
}

template <Mode kMode>
Handler load_handler(Op op, Op first) {
  switch (static_cast<int>(op) - static_cast<int>(first)) {
    case 0:
      return load<std::int8_t, kMode>;
    case 1:
      return load<std::int16_t, kMode>;
    case 2:
      return load<std::int32_t, kMode>;
    case 3:
      return load<std::uint8_t, kMode>;
    default:
      return load<std::uint16_t, kMode>;
  }
}
template <Mode kMode>
Handler store_handler(Op op, Op first) {
  switch (static_cast<int>(op) - static_cast<int>(first)) {
    case 0:
      return store<std::uint8_t, kMode>;
    case 1:
      return store<std::uint16_t, kMode>;
    default:
      return store<std::uint32_t, kMode>;
  }
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

template <auto Compute>
Handler either(Operand operand) {
  return operand == Operand::immediate ? binary<Compute, Operand::immediate> : binary<Compute, Operand::reg>;
}

/// A SIMD operation on parts of type T; Parts is what happens to a pair of them.
template <typename T, auto Parts>
Handler simd(Operand operand) {
  constexpr auto kCompute = f::simd<T, Parts>;
  switch (operand) {
    case Operand::scalar:
      return binary<kCompute, Operand::scalar, T>;
    case Operand::immediate:
      return binary<kCompute, Operand::immediate>;
    default:
      return binary<kCompute, Operand::reg>;
  }
}

template <typename A, typename B>
Handler dot(Operand operand) {
  constexpr Word (*kCompute)(Word, Word) = f::dot<A, B>;
  switch (operand) {
    case Operand::scalar:
      return binary<kCompute, Operand::scalar, B>;
    case Operand::immediate:
      return binary<kCompute, Operand::immediate>;
    default:
      return binary<kCompute, Operand::reg>;
  }
}
template <typename A, typename B>
Handler sum_dot(Operand operand) {
  constexpr Word (*kCompute)(Word, Word, Word) = f::dot<A, B>;
  switch (operand) {
    case Operand::scalar:
      return accumulate<kCompute, Operand::scalar, B>;
    case Operand::immediate:
      return accumulate<kCompute, Operand::immediate>;
    default:
      return accumulate<kCompute, Operand::reg>;
  }
}

Handler simd_handler_of(Op op, Operand operand) {
  using I16 = std::int16_t;
  using U16 = std::uint16_t;
  using I8 = std::int8_t;
  using U8 = std::uint8_t;
  namespace p = f::parts;
  switch (op) {
    case Op::pv_add_h:
      return simd<U16, p::kAdd>(operand);
    case Op::pv_add_b:
      return simd<U8, p::kAdd>(operand);
    case Op::pv_sub_h:
      return simd<U16, p::kSub>(operand);
    case Op::pv_sub_b:
      return simd<U8, p::kSub>(operand);
    case Op::pv_avg_h:
      return simd<I16, p::kAverage>(operand);
    case Op::pv_avg_b:
      return simd<I8, p::kAverage>(operand);
    case Op::pv_avgu_h:
      return simd<U16, p::kAverage>(operand);
    case Op::pv_avgu_b:
      return simd<U8, p::kAverage>(operand);
    case Op::pv_min_h:
      return simd<I16, p::kMin>(operand);
    case Op::pv_min_b:
      return simd<I8, p::kMin>(operand);
    case Op::pv_minu_h:
      return simd<U16, p::kMin>(operand);
    case Op::pv_minu_b:
      return simd<U8, p::kMin>(operand);
    case Op::pv_max_h:
      return simd<I16, p::kMax>(operand);
    case Op::pv_max_b:
      return simd<I8, p::kMax>(operand);
    case Op::pv_maxu_h:
      return simd<U16, p::kMax>(operand);
    case Op::pv_maxu_b:
      return simd<U8, p::kMax>(operand);
    case Op::pv_srl_h:
      return simd<U16, p::kShiftRight>(operand);
    case Op::pv_srl_b:
      return simd<U8, p::kShiftRight>(operand);
    case Op::pv_sra_h:
      return simd<I16, p::kShiftRight>(operand);
    case Op::pv_sra_b:
      return simd<I8, p::kShiftRight>(operand);
    case Op::pv_sll_h:
      return simd<U16, p::kShiftLeft>(operand);
    case Op::pv_sll_b:
      return simd<U8, p::kShiftLeft>(operand);
    case Op::pv_or_h:
      return operand == Operand::scalar ? binary<f::bit_or, Operand::scalar, U16> : either<f::bit_or>(operand);
    case Op::pv_or_b:
      return operand == Operand::scalar ? binary<f::bit_or, Operand::scalar, U8> : either<f::bit_or>(operand);
    case Op::pv_xor_h:
      return operand == Operand::scalar ? binary<f::bit_xor, Operand::scalar, U16> : either<f::bit_xor>(operand);
    case Op::pv_xor_b:
      return operand == Operand::scalar ? binary<f::bit_xor, Operand::scalar, U8> : either<f::bit_xor>(operand);
    case Op::pv_and_h:
      return operand == Operand::scalar ? binary<f::bit_and, Operand::scalar, U16> : either<f::bit_and>(operand);
    case Op::pv_and_b:
      return operand == Operand::scalar ? binary<f::bit_and, Operand::scalar, U8> : either<f::bit_and>(operand);
    case Op::pv_abs_h:
      return unary<f::simd_abs<I16>>;
    case Op::pv_abs_b:
      return unary<f::simd_abs<I8>>;
    case Op::pv_extract_h:
      return binary<f::extract_part<I16>, Operand::immediate>;
    case Op::pv_extract_b:
      return binary<f::extract_part<I8>, Operand::immediate>;
    case Op::pv_extractu_h:
      return binary<f::extract_part<U16>, Operand::immediate>;
    case Op::pv_extractu_b:
      return binary<f::extract_part<U8>, Operand::immediate>;
    case Op::pv_insert_h:
      return accumulate<f::insert_part<U16>, Operand::immediate>;
    case Op::pv_insert_b:
      return accumulate<f::insert_part<U8>, Operand::immediate>;
    case Op::pv_shuffle_h:
      return either<f::shuffle<U16>>(operand);
    case Op::pv_shuffle_b:
      return either<f::shuffle<U8>>(operand);
    case Op::pv_shuffle2_h:
      return accumulate<f::shuffle2<U16>, Operand::reg>;
    case Op::pv_shuffle2_b:
      return accumulate<f::shuffle2<U8>, Operand::reg>;
    case Op::pv_pack_h:
      return binary<f::pack, Operand::reg>;
    case Op::pv_packhi_b:
      return accumulate<f::packhi, Operand::reg>;
    case Op::pv_packlo_b:
      return accumulate<f::packlo, Operand::reg>;
    case Op::pv_cmpeq_h:
      return simd<U16, p::kEqual>(operand);
    case Op::pv_cmpeq_b:
      return simd<U8, p::kEqual>(operand);
    case Op::pv_cmpne_h:
      return simd<U16, p::kNotEqual>(operand);
    case Op::pv_cmpne_b:
      return simd<U8, p::kNotEqual>(operand);
    case Op::pv_cmpgt_h:
      return simd<I16, p::kGreater>(operand);
    case Op::pv_cmpgt_b:
      return simd<I8, p::kGreater>(operand);
    case Op::pv_cmpge_h:
      return simd<I16, p::kGreaterEqual>(operand);
    case Op::pv_cmpge_b:
      return simd<I8, p::kGreaterEqual>(operand);
    case Op::pv_cmplt_h:
      return simd<I16, p::kLess>(operand);
    case Op::pv_cmplt_b:
      return simd<I8, p::kLess>(operand);
    case Op::pv_cmple_h:
      return simd<I16, p::kLessEqual>(operand);
    case Op::pv_cmple_b:
      return simd<I8, p::kLessEqual>(operand);
    case Op::pv_cmpgtu_h:
      return simd<U16, p::kGreater>(operand);
    case Op::pv_cmpgtu_b:
      return simd<U8, p::kGreater>(operand);
    case Op::pv_cmpgeu_h:
      return simd<U16, p::kGreaterEqual>(operand);
    case Op::pv_cmpgeu_b:
      return simd<U8, p::kGreaterEqual>(operand);
    case Op::pv_cmpltu_h:
      return simd<U16, p::kLess>(operand);
    case Op::pv_cmpltu_b:
      return simd<U8, p::kLess>(operand);
    case Op::pv_cmpleu_h:
      return simd<U16, p::kLessEqual>(operand);
    case Op::pv_cmpleu_b:
      return simd<U8, p::kLessEqual>(operand);
    case Op::pv_dotup_h:
      return dot<U16, U16>(operand);
    case Op::pv_dotup_b:
      return dot<U8, U8>(operand);
    case Op::pv_dotusp_h:
      return dot<U16, I16>(operand);
    case Op::pv_dotusp_b:
      return dot<U8, I8>(operand);
    case Op::pv_dotsp_h:
      return dot<I16, I16>(operand);
    case Op::pv_dotsp_b:
      return dot<I8, I8>(operand);
    case Op::pv_sdotup_h:
      return sum_dot<U16, U16>(operand);
    case Op::pv_sdotup_b:
      return sum_dot<U8, U8>(operand);
    case Op::pv_sdotusp_h:
      return sum_dot<U16, I16>(operand);
    case Op::pv_sdotusp_b:
      return sum_dot<U8, I8>(operand);
    case Op::pv_sdotsp_h:
      return sum_dot<I16, I16>(operand);
    case Op::pv_sdotsp_b:
      return sum_dot<I8, I8>(operand);
    default:
      return nullptr;
  }
}

template <bool kSigned, bool kHigh, bool kRounds>
constexpr auto halves() {
  constexpr auto kHalf =
      kSigned ? (kHigh ? f::high_signed : f::low_signed) : (kHigh ? f::high_unsigned : f::low_unsigned);
  return f::multiply_halves < kHalf, kSigned ? f::sra : f::srl, kRounds > ;
}

}  // namespace

Handler xpulp_handler_of(Op op, Operand operand) {
  if (is_simd(op)) return simd_handler_of(op, operand);
  if (op >= Op::p_lb_reg && op <= Op::p_lhu_reg) return load_handler<Mode::offset_register>(op, Op::p_lb_reg);
  if (op >= Op::p_lb_post && op <= Op::p_lhu_post) return load_handler<Mode::post_immediate>(op, Op::p_lb_post);
  if (op >= Op::p_lb_post_reg && op <= Op::p_lhu_post_reg) {
    return load_handler<Mode::post_register>(op, Op::p_lb_post_reg);
  }
  if (op >= Op::p_sb_reg && op <= Op::p_sw_reg) return store_handler<Mode::offset_register>(op, Op::p_sb_reg);
  if (op >= Op::p_sb_post && op <= Op::p_sw_post) return store_handler<Mode::post_immediate>(op, Op::p_sb_post);
  if (op >= Op::p_sb_post_reg && op <= Op::p_sw_post_reg) {
    return store_handler<Mode::post_register>(op, Op::p_sb_post_reg);
  }
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
      return binary<f::slet, Operand::reg>;
    case Op::p_sletu:
      return binary<f::sletu, Operand::reg>;
    case Op::p_min:
      return binary<f::min, Operand::reg>;
    case Op::p_minu:
      return binary<f::minu, Operand::reg>;
    case Op::p_max:
      return binary<f::max, Operand::reg>;
    case Op::p_maxu:
      return binary<f::maxu, Operand::reg>;
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
      return accumulate<shift_register<f::addN>, Operand::reg>;
    case Op::p_adduNr:
      return accumulate<shift_register<f::adduN>, Operand::reg>;
    case Op::p_addRNr:
      return accumulate<shift_register<f::addRN>, Operand::reg>;
    case Op::p_adduRNr:
      return accumulate<shift_register<f::adduRN>, Operand::reg>;
    case Op::p_subNr:
      return accumulate<shift_register<f::subN>, Operand::reg>;
    case Op::p_subuNr:
      return accumulate<shift_register<f::subuN>, Operand::reg>;
    case Op::p_subRNr:
      return accumulate<shift_register<f::subRN>, Operand::reg>;
    case Op::p_subuRNr:
      return accumulate<shift_register<f::subuRN>, Operand::reg>;
    case Op::p_extract:
      return either<f::extract>(operand);
    case Op::p_extractu:
      return either<f::extractu>(operand);
    case Op::p_insert:
      return operand == Operand::immediate ? accumulate<f::insert, Operand::immediate>
                                           : accumulate<f::insert, Operand::reg>;
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
      return binary<f::ror, Operand::reg>;
    case Op::p_mac:
      return accumulate<f::mac, Operand::reg>;
    case Op::p_msu:
      return accumulate<f::msu, Operand::reg>;
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
