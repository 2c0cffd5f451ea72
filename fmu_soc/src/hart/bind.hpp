// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/handler.hpp"
#include "isa/operations_simd.hpp"

#include <cstdint>

namespace mebots::soc {

// Handlers that compute a register: Compute is an operation of src/isa/operations*.hpp.

/// The second operand of an instruction, from where its form has it. T is the type of a part, which a scalar is copied
/// into.
template <Operand kFrom, typename T = std::int32_t>
[[gnu::always_inline]] inline std::uint32_t second(const Execution& e, const Instruction* at) {
  if constexpr (kFrom == Operand::immediate) return static_cast<std::uint32_t>(at->imm);
  if constexpr (kFrom == Operand::scalar) return operations::in_all_parts<T>(e.x[at->rs2]);
  return e.x[at->rs2];
}

template <auto Compute>
const Instruction* unary(Execution& e, const Instruction* at) {
  e.x[at->rd] = Compute(e.x[at->rs1]);
  return next(e, at);
}

template <auto Compute, Operand kFrom = Operand::reg, typename T = std::int32_t>
const Instruction* binary(Execution& e, const Instruction* at) {
  e.x[at->rd] = Compute(e.x[at->rs1], second<kFrom, T>(e, at));
  return next(e, at);
}

/// Also reads rd. (For rd = x0 that is something else, but so is what it writes.)
template <auto Compute, Operand kFrom = Operand::reg, typename T = std::int32_t>
const Instruction* accumulate(Execution& e, const Instruction* at) {
  e.x[at->rd] = Compute(e.x[at->rd], e.x[at->rs1], second<kFrom, T>(e, at));
  return next(e, at);
}

/// A meaning that has one handler, wherever the second operand comes from.
template <Handler kHandler>
Handler always(Operand) {
  return kHandler;
}

/// With a register or an immediate as second operand.
template <auto Compute>
Handler either(Operand operand) {
  return operand == Operand::immediate ? binary<Compute, Operand::immediate> : binary<Compute, Operand::reg>;
}
template <auto Compute>
Handler accumulate_either(Operand operand) {
  return operand == Operand::immediate ? accumulate<Compute, Operand::immediate> : accumulate<Compute, Operand::reg>;
}

}  // namespace mebots::soc
