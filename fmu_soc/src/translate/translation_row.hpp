// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/instruction.hpp"
#include "isa/op.hpp"

namespace mebots::soc::translate {

class Emitter;

/// How an instruction becomes host code: its place in the column of translations of isa/instructions.inc.
struct Translation {
  /// False: nothing emitted, this form of it is left to the interpreter. Null: all forms are.
  bool (*emit)(Emitter&, const Instruction*) = nullptr;
  bool leaves_block = false;  // no other instruction of its block comes behind it
};

const Translation& translation_of(Op op);

}  // namespace mebots::soc::translate
