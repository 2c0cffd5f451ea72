// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace mebots::soc {

/// An operation, independent of its encoding: `c.addi` and `addi` are both `addi`.
enum class Op : std::uint16_t {
#include "fmu_soc_isa/op_enum.inc"
};

/// Kinds of operations, for timing, decoding and translation. `other` contains plain arithmetic and operations with
/// special handlers.
enum class OpKind : std::uint8_t {
  other,
  branch,
  jump,
  load,
  store,
  multiply_high,
  divide,
  csr,
  csr_immediate,
  hardware_loop,
  shifted_sum,          // Xpulp: adds or subtracts, then shifts right
  multiply_accumulate,  // Xpulp: multiplies words and adds the product
  multiply_halves,      // Xpulp: multiplies, may add, then shifts right
  simd,                 // Xpulp: works on halves or bytes, like the next four kinds
  simd_compare,
  simd_shift,
  simd_parts,  // copies halves or bytes
  dot_product,
  float_arithmetic,  // F: sums; the next six kinds also belong to F
  float_multiply,
  float_multiply_add,
  float_divide,
  float_root,
  float_convert,  // conversion from or to an integer
  float_other,    // signs, comparisons, classes and moves
  block_end,      // slot after the last instruction of a decoded block
};

/// Determines the address of a load or store, and the new value of its address register.
enum class AddressMode : std::uint8_t { offset, offset_register, post_immediate, post_register };

/// Returns true if a register contains the offset or increment.
constexpr bool has_step_register(AddressMode mode) {
  return mode == AddressMode::offset_register || mode == AddressMode::post_register;
}

/// The condition that a SIMD comparison tests for each pair of parts.
enum class Relation : std::uint8_t { eq, ne, gt, ge, lt, le };

// Cycles of instructions that take several cycles, measured on the RTL (hart/timing.hpp).
inline constexpr unsigned kMultiplyHighCycles = 5;
inline constexpr unsigned kDivideBaseCycles = 3;
inline constexpr unsigned kFenceCycles = 4;
/// Maximum numbers of cycles in CV32E40P's user manual for FPU_ADDMUL_LAT = FPU_OTHERS_LAT = 0. All other
/// floating-point operations then take one cycle. The real core may continue earlier if the next instructions do not
/// need the result.
inline constexpr unsigned kFloatDivideCycles = 19;
inline constexpr unsigned kFloatRootCycles = 19;
/// Number of cycles that mret takes. Only the sum of a trap's entry and mret was measured: 9 cycles. The division into
/// 4 and 5 is an assumption.
inline constexpr unsigned kMretCycles = 5;

/// Properties that all encodings of an operation share. Properties that do not apply to a kind have their default
/// values.
struct OpTraits {
  OpKind kind = OpKind::other;
  std::uint8_t size = 0;   // bytes that a load or store accesses
  std::uint8_t parts = 0;  // SIMD: 2 for halves, 4 for bytes
  bool sign = false;  // operands are signed; for a dot product, only the first one; for a load, the sign is extended
  AddressMode mode = AddressMode::offset;
  Relation relation = Relation::eq;
  bool second_sign = false;  // dot product: the second operand is signed
  bool reads_rd = false;     // also reads rd; a shifted sum is then shifted by a register
  bool rounds = false;       // rounds before it shifts
  bool subtracts = false;
  bool high = false;        // uses the upper halves
  bool ends_block = false;  // a block ends here: the next instruction is unknown, or may depend on this one
  unsigned cycles = 1;      // without cycles that depend on data; for CSR accesses, see Timing::csr_cycles()
  bool reads_rs2 = true;    // if false, the field rs2 contains a value or the number of a loop
  bool atomic = false;      // operation of the A extension
  bool floats = false;      // operation of F or Zfinx
};

namespace op_rows {

inline constexpr auto kTraits = std::to_array<OpTraits>({
#include "fmu_soc_isa/op_traits.inc"
});

/// Returns a name such as "op 1f0a93c2", whose digits are a hash (FNV-1a) of the names of all operations.
consteval auto name_in_states() {
  std::uint32_t hash = 0x811c9dc5;
  for (const char letter : std::string_view(
#include "fmu_soc_isa/op_names.inc"
           )) {
    hash = (hash ^ static_cast<unsigned char>(letter)) * 0x01000193;
  }
  std::array<char, 11> text{'o', 'p', ' '};
  for (std::size_t digit = 0; digit < 8; ++digit) text[3 + digit] = "0123456789abcdef"[hash >> (28 - 4 * digit) & 15];
  return text;
}

inline constexpr auto kNameInStates = name_in_states();

}  // namespace op_rows

/// Name under which a saved state contains the number of an operation. A build with other operations uses another name,
/// and therefore refuses the state.
inline constexpr std::string_view kOpInStates(op_rows::kNameInStates.data(), op_rows::kNameInStates.size());

inline constexpr int kOpCount = static_cast<int>(op_rows::kTraits.size());

constexpr const OpTraits& traits_of(Op op) {
  return op_rows::kTraits[static_cast<std::size_t>(op)];
}
constexpr bool is_load(Op op) {
  return traits_of(op).kind == OpKind::load;
}
constexpr bool is_store(Op op) {
  return traits_of(op).kind == OpKind::store;
}
constexpr bool is_post_increment(Op op) {
  const auto mode = traits_of(op).mode;
  return mode == AddressMode::post_immediate || mode == AddressMode::post_register;
}
constexpr bool is_branch(Op op) {
  return traits_of(op).kind == OpKind::branch;
}
constexpr bool is_jump(Op op) {
  return traits_of(op).kind == OpKind::jump;
}
/// True for the operations that enter or leave a trap handler, except ebreak.
constexpr bool is_trap(Op op) {
  return op == Op::ecall || op == Op::mret;
}
constexpr bool is_multiply_high(Op op) {
  return traits_of(op).kind == OpKind::multiply_high;
}
constexpr bool is_divide(Op op) {
  return traits_of(op).kind == OpKind::divide;
}
/// Returns true for mulh* and divisions, which always take several cycles.
constexpr bool is_multi_cycle(Op op) {
  return is_multiply_high(op) || is_divide(op);
}
constexpr bool is_csr(Op op) {
  return traits_of(op).kind == OpKind::csr || traits_of(op).kind == OpKind::csr_immediate;
}
constexpr bool reads_rd(Op op) {
  return traits_of(op).reads_rd;
}
constexpr bool is_hardware_loop(Op op) {
  return traits_of(op).kind == OpKind::hardware_loop;
}
constexpr bool is_simd(Op op) {
  return traits_of(op).parts != 0;
}
constexpr bool is_dot_product(Op op) {
  return traits_of(op).kind == OpKind::dot_product;
}
constexpr bool is_multiply_accumulate(Op op) {
  return traits_of(op).kind == OpKind::multiply_accumulate || traits_of(op).kind == OpKind::multiply_halves;
}
/// Returns true for operations of F or Zfinx, which are illegal while the floating-point unit is off.
constexpr bool is_float(Op op) {
  return traits_of(op).floats;
}
constexpr bool is_atomic(Op op) {
  return traits_of(op).atomic;
}
/// Returns true if the operation reads a third register. The immediate contains the number of this register, above the
/// rounding mode.
constexpr bool is_float_multiply_add(Op op) {
  return traits_of(op).kind == OpKind::float_multiply_add;
}
constexpr bool is_block_end(Op op) {
  return traits_of(op).kind == OpKind::block_end;
}
constexpr bool ends_block(Op op) {
  return traits_of(op).ends_block;
}

}  // namespace mebots::soc
