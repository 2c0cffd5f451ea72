// SPDX-License-Identifier: Apache-2.0
#include "instructions/operation.hpp"

#include "mebots/assert.hpp"
#include "translate/translator.hpp"

#include <cstddef>

namespace mebots::soc {
namespace {

constexpr auto kAll = [] {
  std::array<const Operation*, kOpCount> all{};
  std::size_t next = 0;
#define MEBOTS_FAMILY(family, count) \
  for (std::size_t i = 0; i < (count); ++i) all[next++] = &family::kOperations[i];
#include "fmu_soc_isa/families.inc"
#undef MEBOTS_FAMILY
  return all;
}();

}  // namespace

const Operation& operation_of(Op op) {
  MEBOTS_ASSERT(static_cast<int>(op) < kOpCount);
  return *kAll[static_cast<std::size_t>(op)];
}

Handler handler_of(Op op, Operand operand) {
  return operation_of(op).handlers[static_cast<std::size_t>(operand)];
}

Compute compute_of(Op op) {
  return operation_of(op).compute;
}

Compare compare_of(Op op) {
  return operation_of(op).compare;
}

Operand operand_of(const Instruction& instruction) {
  for (const auto operand : {Operand::immediate, Operand::scalar}) {
    if (instruction.run != handler_of(instruction.op) && instruction.run == handler_of(instruction.op, operand)) {
      return operand;
    }
  }
  return Operand::reg;
}

translate::Lowering translate::lowering_of(Op op) {
  return operation_of(op).emit;
}

bool translate::has_translation(Op op) {
  return operation_of(op).emit != nullptr;
}

}  // namespace mebots::soc
