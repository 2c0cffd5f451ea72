// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/instruction.hpp"
#include "isa/op.hpp"

namespace mebots::soc::translate {

class Assembler;

/// Writes host code for an instruction. False: nothing was written, this form of it is left to the interpreter.
using Lowering = bool (*)(Assembler&, const Instruction*);

/// The lowering of an operation; null if all forms are left to the interpreter.
Lowering lowering_of(Op op);

}  // namespace mebots::soc::translate
