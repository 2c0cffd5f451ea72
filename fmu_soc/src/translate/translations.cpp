// SPDX-License-Identifier: Apache-2.0
//
// The column of translations of isa/instructions.inc: of each operation which emitter, and what that is told beside the
// instruction.
#include "translate/emitter.hpp"
#include "translate/host.hpp"
#include "translate/translation_row.hpp"
#include "translate/translator.hpp"

#include <array>
#include <type_traits>

namespace mebots::soc::translate {
namespace translations {
namespace {

constexpr bool kSigned = true;
constexpr bool kUnsigned = false;
constexpr bool kHigh = true;
constexpr bool kLow = false;
using Shift = Emitter::PartShift;

/// Calls a member of the emitter. One that says nothing has always emitted something.
template <auto kEmit, auto... kHow>
bool call(Emitter& emitter, const Instruction* at) {
  if constexpr (std::is_void_v<decltype((emitter.*kEmit)(at, kHow...))>) {
    (emitter.*kEmit)(at, kHow...);
    return true;
  } else {
    return (emitter.*kEmit)(at, kHow...);
  }
}

/// Always left to the interpreter.
constexpr Translation interpreted() {
  return {};
}

// Standard instructions
constexpr Translation constant() {
  return {call<&Emitter::emit_constant>};
}
constexpr Translation nothing() {
  return {call<&Emitter::emit_nothing>};
}
constexpr Translation add_immediate() {
  return {call<&Emitter::emit_add_immediate>};
}
constexpr Translation add_registers() {
  return {call<&Emitter::emit_add>};
}
template <host::Binary kApply>
constexpr Translation binary() {
  return {call<&Emitter::emit_binary, kApply>};
}
template <host::Immediate kApply>
constexpr Translation immediate() {
  return {call<&Emitter::emit_immediate, kApply>};
}
template <host::ShiftImmediate kApply>
constexpr Translation shift_immediate() {
  return {call<&Emitter::emit_shift_immediate, kApply>};
}
template <host::Shift kApply>
constexpr Translation shift() {
  return {call<&Emitter::emit_shift, kApply>};
}
template <host::Set kSet>
constexpr Translation set() {
  return {call<&Emitter::emit_set, kSet>};
}
template <host::Set kSet>
constexpr Translation set_immediate() {
  return {call<&Emitter::emit_set_immediate, kSet>};
}
template <bool kFirstSign, bool kSecondSign>
constexpr Translation multiply_high() {
  return {call<&Emitter::emit_multiply_high, kFirstSign, kSecondSign>};
}
template <bool kSign>
constexpr Translation quotient() {
  return {call<&Emitter::emit_divide, kSign, false>};
}
template <bool kSign>
constexpr Translation remainder() {
  return {call<&Emitter::emit_divide, kSign, true>};
}
constexpr Translation load() {
  return {call<&Emitter::emit_load>};
}
constexpr Translation store() {
  return {call<&Emitter::emit_store>};
}
template <host::Branch kTaken>
constexpr Translation branch() {
  return {call<&Emitter::emit_branch, kTaken>};
}
template <host::Branch kTaken>
constexpr Translation branch_immediate() {
  return {call<&Emitter::emit_branch_immediate, kTaken>};
}
constexpr Translation jump() {
  return {.emit = call<&Emitter::emit_jump>, .leaves_block = true};
}
constexpr Translation jump_register() {
  return {.emit = call<&Emitter::emit_jump_register>, .leaves_block = true};
}
constexpr Translation end_of_block() {
  return {.emit = call<&Emitter::emit_end>, .leaves_block = true};
}

// Xpulp: hardware loops
constexpr Translation loop_start() {
  return {call<&Emitter::emit_loop_start>};
}
constexpr Translation loop_end_at() {
  return {call<&Emitter::emit_loop_end_at>};
}
constexpr Translation loop_count() {
  return {call<&Emitter::emit_loop_count>};
}
constexpr Translation loop_count_immediate() {
  return {call<&Emitter::emit_loop_count_immediate>};
}
constexpr Translation loop_setup() {
  return {call<&Emitter::emit_loop_setup>};
}
constexpr Translation loop_setup_immediate() {
  return {call<&Emitter::emit_loop_setup_immediate>};
}

// Xpulp: words
constexpr Translation absolute() {
  return {call<&Emitter::emit_absolute>};
}
template <host::Binary kApply>
constexpr Translation unary() {
  return {call<&Emitter::emit_unary, kApply>};
}
template <host::Binary kMove>
constexpr Translation select() {
  return {call<&Emitter::emit_select, kMove>};
}
template <bool kSign, unsigned kBits>
constexpr Translation extend() {
  return {call<&Emitter::emit_extend, kSign, kBits>};
}
template <bool kSign>
constexpr Translation clip() {
  return {call<&Emitter::emit_clip, kSign>};
}
template <bool kSign>
constexpr Translation extract_field() {
  return {call<&Emitter::emit_extract_field, kSign>};
}
constexpr Translation insert_field() {
  return {call<&Emitter::emit_insert_field>};
}
constexpr Translation clear_field() {
  return {call<&Emitter::emit_clear_field>};
}
constexpr Translation set_field() {
  return {call<&Emitter::emit_set_field>};
}
constexpr Translation find_last() {
  return {call<&Emitter::emit_find_last>};
}
constexpr Translation rotate() {
  return {call<&Emitter::emit_rotate>};
}
constexpr Translation multiply_add() {
  return {call<&Emitter::emit_multiply_accumulate, false>};
}
constexpr Translation multiply_subtract() {
  return {call<&Emitter::emit_multiply_accumulate, true>};
}
constexpr Translation multiply_halves() {
  return {call<&Emitter::emit_multiply_halves>};
}
constexpr Translation shifted_sum() {
  return {call<&Emitter::emit_shifted_sum>};
}

// Xpulp: halves and bytes
template <host::Packed kApply>
constexpr Translation packed() {
  return {call<&Emitter::emit_packed, kApply>};
}
template <host::Packed kApply>
constexpr Translation packed_unary() {
  return {call<&Emitter::emit_packed_unary, kApply>};
}
template <bool kSign>
constexpr Translation average() {
  return {call<&Emitter::emit_average, kSign>};
}
template <host::Binary kApply>
constexpr Translation logic() {
  return {call<&Emitter::emit_logic, kApply>};
}
constexpr Translation compare_parts() {
  return {call<&Emitter::emit_compare_parts>};
}
template <Shift kShift>
constexpr Translation shift_parts() {
  return {call<&Emitter::emit_shift_parts, kShift>};
}
constexpr Translation dot_product() {
  return {call<&Emitter::emit_dot>};
}
constexpr Translation extract_part() {
  return {call<&Emitter::emit_extract_part>};
}
constexpr Translation insert_part() {
  return {call<&Emitter::emit_insert_part>};
}
constexpr Translation shuffle() {
  return {call<&Emitter::emit_shuffle>};
}
template <bool kOfHigh>
constexpr Translation pack_halves() {
  return {call<&Emitter::emit_pack_halves, kOfHigh>};
}
template <bool kIntoHigh>
constexpr Translation pack_bytes() {
  return {call<&Emitter::emit_pack_bytes, kIntoHigh>};
}

constexpr auto kTranslations = std::to_array<Translation>({
#define MEBOTS_OP(name, traits, meaning, translation, ...) translation(),
#include "isa/instructions.inc"
});

}  // namespace
}  // namespace translations

const Translation& translation_of(Op op) {
  return translations::kTranslations[static_cast<std::size_t>(op)];
}

bool has_translation(Op op) {
  return translation_of(op).emit != nullptr;
}

}  // namespace mebots::soc::translate
