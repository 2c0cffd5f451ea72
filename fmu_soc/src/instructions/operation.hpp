// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/handler.hpp"
#include "translate/translator.hpp"

#include <array>
#include <cstdint>
#include <type_traits>

namespace mebots::soc {

using Word = std::uint32_t;
using translate::Lowering;

constexpr std::int32_t as_signed(Word word) {
  return static_cast<std::int32_t>(word);
}

/// An operation: its handlers for the interpreter and its lowering to host code. operation() creates it from two
/// functions, which the tables isa/*.decode name.
struct Operation {
  std::array<Handler, 3> handlers{};  // indexed by Operand
  Lowering emit = nullptr;            // null: the interpreter executes all forms of the operation
  Compute compute = nullptr;          // if not null: rd = compute(rs1, second operand)
  Compare compare = nullptr;          // if not null: the operation is a branch, taken if compare() returns true
};

const Operation& operation_of(Op op);

namespace binding {

template <typename Function>
struct Signature;
template <typename R, typename... Arguments>
struct Signature<R (*)(Arguments...)> {
  using Result = R;
  static constexpr std::size_t kCount = sizeof...(Arguments);
};

/// Returns the second operand. A scalar is copied into all parts. In some encodings, the field rs2 contains a signed
/// 5-bit value.
template <Op kOp, Operand kFrom>
[[gnu::always_inline]] inline Word second(const Execution& e, const Instruction* at) {
  if constexpr (kFrom == Operand::immediate) {
    return static_cast<Word>(at->imm);
  } else if constexpr (kFrom == Operand::scalar) {
    const auto value = e.x[at->rs2];
    return traits_of(kOp).parts == 4 ? (value & 0xffU) * 0x01010101U : (value & 0xffffU) * 0x00010001U;
  } else if constexpr (!traits_of(kOp).reads_rs2) {
    return static_cast<Word>(static_cast<std::int32_t>(Word{at->rs2} << 27) >> 27);
  } else {
    return e.x[at->rs2];
  }
}

/// Handler that calls `kExecute` and writes the result to rd. The arguments are rs1, the second operand and the
/// immediate, as many as the function has. If the operation reads rd, the value of rd comes first.
template <Op kOp, Operand kFrom, auto kExecute>
const Instruction* run(Execution& e, const Instruction* at) {
  constexpr auto kCount = Signature<decltype(kExecute)>::kCount;
  constexpr bool kReadsRd = traits_of(kOp).reads_rd;
  const auto imm = static_cast<Word>(at->imm);
  if constexpr (is_branch(kOp)) {
    return kExecute(e.x[at->rs1], second<kOp, kFrom>(e, at)) ? take_branch(e, at) : next(e, at);
  } else if constexpr (is_divide(kOp)) {
    const auto divisor = e.x[at->rs2];
    e.extra_cycles += traits_of(kOp).sign ? divide_extra_signed(divisor) : divide_extra_unsigned(divisor);
    e.x[at->rd] = kExecute(e.x[at->rs1], divisor);
  } else if constexpr (kCount == 1) {
    e.x[at->rd] = kExecute(e.x[at->rs1]);
  } else if constexpr (kCount == 2) {
    e.x[at->rd] = kExecute(e.x[at->rs1], second<kOp, kFrom>(e, at));
  } else if constexpr (kCount == 3 && kReadsRd) {
    e.x[at->rd] = kExecute(e.x[at->rd], e.x[at->rs1], second<kOp, kFrom>(e, at));
  } else if constexpr (kCount == 3) {
    e.x[at->rd] = kExecute(e.x[at->rs1], e.x[at->rs2], imm);
  } else {
    static_assert(kCount == 4 && kReadsRd);
    e.x[at->rd] = kExecute(e.x[at->rd], e.x[at->rs1], e.x[at->rs2], imm);
  }
  return next(e, at);
}

template <Op kOp, auto kExecute, Operand kFrom>
constexpr Handler handler() {
  if constexpr (std::is_same_v<decltype(kExecute), Handler>) {
    return kExecute;
  } else {
    return run<kOp, kFrom, kExecute>;
  }
}

template <auto kEmit>
bool lower(translate::Assembler& c, const Instruction* at) {
  if constexpr (std::is_void_v<decltype(kEmit(c, at))>) {
    kEmit(c, at);
    return true;
  } else {
    return kEmit(c, at);
  }
}

}  // namespace binding

/// Returns the Operation for encodings whose second operand is one of `kOperands`. For each other kind of operand, the
/// handler is that of a register. If `kOperands` contains no register, it is that of the first kind in `kOperands`.
template <Op kOp, auto kExecute, Operand... kOperands>
constexpr Operation operation(Lowering emit) {
  constexpr std::array kGiven{kOperands..., Operand::reg};
  constexpr bool kHasRegister = sizeof...(kOperands) == 0 || ((kOperands == Operand::reg) || ...);
  constexpr auto kDefault = kHasRegister ? Operand::reg : kGiven[0];
  constexpr bool kHasScalar = ((kOperands == Operand::scalar) || ...);
  constexpr bool kHasImmediate = ((kOperands == Operand::immediate) || ...);
  using binding::handler;
  Operation made{.handlers = {handler<kOp, kExecute, kDefault>(), handler < kOp, kExecute,
                              kHasScalar ? Operand::scalar : kDefault > (), handler < kOp, kExecute,
                              kHasImmediate ? Operand::immediate : kDefault > ()},
                 .emit = emit};
  using Type = decltype(kExecute);
  if constexpr (std::is_same_v<Type, decltype(made.compute)>) made.compute = kExecute;
  if constexpr (std::is_same_v<Type, decltype(made.compare)>) made.compare = kExecute;
  return made;
}

// The generated tables contain macros such as MEBOTS_LOWERING(emit_add).
#ifdef MEBOTS_TRANSLATES
#define MEBOTS_LOWERING(emit) binding::lower<emit>
#else
#define MEBOTS_LOWERING(emit) nullptr
#endif

// Declares the operations of each family, in the order of the rows of its table isa/*.decode.
#define MEBOTS_FAMILY(family, count)         \
  namespace family {                         \
  extern const Operation kOperations[count]; \
  }
#include "fmu_soc_isa/families.inc"
#undef MEBOTS_FAMILY

}  // namespace mebots::soc
