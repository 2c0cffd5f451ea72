// SPDX-License-Identifier: Apache-2.0
//
// Binds the operations of Xpulp v2 on parts of words (pv.*) to decoded instructions.
#include "hart/bind.hpp"
#include "isa/operations_xpulp.hpp"

namespace mebots::soc {
namespace {

namespace f = operations;
using Word = std::uint32_t;

/// Compute with a second operand from where its form has it; a scalar is copied into parts of type T.
template <auto Compute, typename T>
Handler with_operand(Operand operand) {
  switch (operand) {
    case Operand::scalar:
      return binary<Compute, Operand::scalar, T>;
    case Operand::immediate:
      return binary<Compute, Operand::immediate>;
    default:
      return binary<Compute, Operand::reg>;
  }
}

/// A SIMD operation on parts of type T; Parts is what happens to a pair of them.
template <typename T, auto Parts>
Handler simd(Operand operand) {
  return with_operand<f::simd<T, Parts>, T>(operand);
}

template <typename A, typename B>
Handler dot(Operand operand) {
  constexpr Word (*kCompute)(Word, Word) = f::dot<A, B>;
  return with_operand<kCompute, B>(operand);
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

}  // namespace

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

}  // namespace mebots::soc
