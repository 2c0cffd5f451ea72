// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/instruction.hpp"
#include "isa/op.hpp"

namespace mebots::soc::translate {

class Emitter;

/// Which registers of an instruction may live in a vector register: those that its emitter moves only as a whole
/// (Emitter::copy, value, finish, set).
struct InVector {
  bool target = false;    // rd
  bool first = false;     // rs1
  bool second = false;    // rs2
  bool in_place = false;  // also one that is both rd and a source
};

/// How an instruction becomes host code: its place in the column of translations of isa/instructions.inc.
struct Translation {
  /// False: nothing emitted, this form of it is left to the interpreter. Null: all forms are.
  bool (*emit)(Emitter&, const Instruction*) = nullptr;
  InVector in_vector{};
  bool leaves_block = false;  // no other instruction of its block comes behind it
};

const Translation& translation_of(Op op);

}  // namespace mebots::soc::translate
