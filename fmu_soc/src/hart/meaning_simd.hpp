// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/bind.hpp"
#include "isa/operations_xpulp.hpp"

/// Meanings of Xpulp v2 on parts of words (pv.*): a handler for each place that the second operand can come from.
namespace mebots::soc::meaning {

namespace f = operations;
namespace p = operations::parts;
using Word = std::uint32_t;
using I16 = std::int16_t;
using U16 = std::uint16_t;
using I8 = std::int8_t;
using U8 = std::uint8_t;

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

}  // namespace mebots::soc::meaning
