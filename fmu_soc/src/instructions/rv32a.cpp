// SPDX-License-Identifier: Apache-2.0
//
// Execution of the operations in isa/rv32a.decode (A extension), which have no lowering. Each access is atomic, because
// boards with several cores cannot have this extension (board/board_file.cpp).
#include "hart/data_path.hpp"
#include "instructions/operation.hpp"

#include <algorithm>

namespace mebots::soc::rv32a {
namespace {

/// Returns the value that an operation stores. `word` is the word in memory, and `value` is rs2.
template <Op kOp>
constexpr Word amo(Word word, Word value) {
  switch (kOp) {
    case Op::amoadd_w:
      return word + value;
    case Op::amoxor_w:
      return word ^ value;
    case Op::amoand_w:
      return word & value;
    case Op::amoor_w:
      return word | value;
    case Op::amomin_w:
      return as_signed(word) < as_signed(value) ? word : value;
    case Op::amomax_w:
      return as_signed(word) > as_signed(value) ? word : value;
    case Op::amominu_w:
      return std::min(word, value);
    case Op::amomaxu_w:
      return std::max(word, value);
    default:
      return value;  // amoswap
  }
}

template <Op kOp>
const Instruction* execute_amo(Execution& e, const Instruction* at) {
  return e.units->data_path.amo(at, e.x[at->rs1], e.x[at->rs2], amo<kOp>);
}
const Instruction* execute_lr_w(Execution& e, const Instruction* at) {
  return e.units->data_path.load_reserved(at, e.x[at->rs1]);
}
const Instruction* execute_sc_w(Execution& e, const Instruction* at) {
  return e.units->data_path.store_conditional(at, e.x[at->rs1], e.x[at->rs2]);
}

}  // namespace

constinit const Operation kOperations[] = {
#include "fmu_soc_isa/rv32a.inc"
};

}  // namespace mebots::soc::rv32a
