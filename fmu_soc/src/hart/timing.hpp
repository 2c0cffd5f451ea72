// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isa/extension.hpp"
#include "isa/op.hpp"
#include "mebots/state/visitor.hpp"

#include <bit>
#include <cstdint>
#include <optional>
#include <string_view>

/// Cycles of a single-issue, in-order, four-stage core with memories without wait states, as measured on the RTL of
/// CV32E40P 1.8.3 and of RI5CY (early 2018, as old as GAP8):
///
///   cycles = instructions + 2 x taken branches + 1 x jumps + load-use stalls + jalr stalls
///          + 1 x (jump or taken branch to a 32-bit instruction at an address 2 mod 4)
///          + extra cycles of multi-cycle instructions
namespace mebots::soc {

/// The core that is modelled. `rv32imc` is a generic core with the cycles of CV32E40P and the CSRs of the privileged
/// specification: mtvec is aligned to 4 bytes, counters run after reset, and exceptions write mtval.
enum class CoreKind : std::uint8_t { cv32e40p, ri5cy, rv32imc };

/// Returns the core that a name selects: "cv32e40p", "ri5cy", or an ISA string such as "rv32imc" for a generic core.
/// Returns nullopt for other names.
std::optional<CoreKind> core_kind(std::string_view name);

/// Properties in which the modelled cores differ. Source of CV32E40P's CSRs: its user manual 1.8.3, chapter "Control
/// and status registers". The number of event counters has its default value, 1.
struct Timing {
  CoreKind kind = CoreKind::ri5cy;
  Extensions options = {};   // extensions in addition to RV32IMC and those that the kind always has
  unsigned pmp_entries = 0;  // number of entries of the physical memory protection, 0 to 16

  /// Returns true if a load stalls after a load with the same destination register.
  bool load_after_load_stalls() const { return kind == CoreKind::ri5cy; }
  /// Returns true if a store stalls after a load whose rd is equal to bits 4:0 of the store's offset.
  bool store_offset_looks_like_rd() const { return kind == CoreKind::ri5cy; }
  /// Returns true if an unaligned jump target costs no cycle after the operation `before`. The core then fetches the
  /// target while it still executes this operation.
  bool hides_unaligned_target(Op before) const { return kind == CoreKind::ri5cy && is_multi_cycle(before); }
  /// Returns true if the core has Xpulp v2 in the encodings of RI5CY. CV32E40P has other encodings.
  bool has_xpulp() const { return kind == CoreKind::ri5cy; }
  Extensions extensions() const { return has_xpulp() ? options.with(Extension::xpulp) : options; }
  unsigned csr_cycles(unsigned csr) const;

  std::uint32_t mtvec_mask() const { return kind == CoreKind::cv32e40p ? 0xffffff01U : ~2U; }
  std::uint32_t mtvec_after_reset() const { return kind == CoreKind::cv32e40p ? 1 : 0; }
  std::uint32_t mcountinhibit_mask() const { return kind == CoreKind::cv32e40p ? 0xd : 0x5; }
  std::uint32_t mcountinhibit_after_reset() const { return kind == CoreKind::cv32e40p ? 0xd : 0; }
  bool has_mtval() const { return kind != CoreKind::cv32e40p; }
};

inline constexpr unsigned kTakenBranchExtra = 2;
inline constexpr unsigned kUnalignedTargetExtra = 1;
inline constexpr unsigned kMisalignedExtra = 1;
/// Number of cycles that the entry of a trap takes. Only the sum of entry and mret was measured: 9 cycles. The division
/// into 4 and 5 is an assumption.
inline constexpr unsigned kTrapEntryCycles = 4;

/// The properties of an instruction that affect the cycles of later instructions.
struct Previous {
  Op op = Op::end_of_block;  // end_of_block = no previous instruction
  std::uint8_t rd = 0;       // destination register; 0 or kNoRegister = none
  /// Number of the register that a post-increment has written, or 0. The bit kSlow is also set if the instruction took
  /// several cycles (mulh, div, misaligned load).
  std::uint8_t pointer_and_slow = 0;

  static constexpr std::uint8_t kSlow = 0x80;
  constexpr bool slow() const { return (pointer_and_slow & kSlow) != 0; }
  constexpr std::uint8_t pointer() const { return pointer_and_slow & static_cast<std::uint8_t>(~kSlow); }
  /// Returns true if the instruction has written a register.
  constexpr bool writes() const { return rd != 0 && rd < kRegisters; }

  bool operator==(const Previous&) const = default;
  void visit(state::Visitor& v) {
    v(kOpInStates, op);
    v("rd", rd);
    v("pointer_and_slow", pointer_and_slow);
  }
};

/// Returns the properties of an executed instruction (Decoded or Instruction) that affect later instructions.
template <typename Executed>
Previous executed(const Executed& instruction, bool across_words) {
  const auto pointer = is_post_increment(instruction.op) ? instruction.rs1 : std::uint8_t{0};
  const bool slow = is_multi_cycle(instruction.op) || across_words;
  return {instruction.op, instruction.rd, static_cast<std::uint8_t>(pointer | (slow ? Previous::kSlow : 0))};
}

/// Returns the properties that still matter one instruction later. Clears kSlow, which only affects a jump directly
/// after the slow instruction.
constexpr Previous one_later(Previous before) {
  before.pointer_and_slow = before.pointer();
  return before;
}

/// The fields of an instruction that static_cycles() needs.
struct Current {
  Op op = Op::end_of_block;
  std::uint8_t rd = 0;
  std::uint8_t rs1 = 0;
  std::uint8_t rs2 = 0;
  std::uint8_t rs3 = 0;  // third source register; 0 = none
  std::int32_t imm = 0;
};

/// Returns the cycles of an instruction other than a jump, without stalls and without cycles that depend on data.
unsigned own_cycles(const Timing& timing, const Current& current);

/// Returns the cycles of an instruction that are known from decoding. They depend on the two previous instructions.
/// Excludes cycles of taken branches, operands of divisions, misaligned addresses and unaligned targets.
unsigned static_cycles(const Timing& timing, const Previous& two_before, const Previous& before,
                       const Current& current);

/// Returns true if the instruction is a jump that is fetched while the previous instruction still takes several cycles:
/// see Previous::slow(). Such a jump takes one cycle. A jalr that waits for its address register is not such a jump.
bool overlaps_slow(const Previous& slow, const Current& current);

/// Returns the largest number of cycles that execution can add to static_cycles(), without the cycle for an unaligned
/// target.
unsigned most_extra_cycles(Op op);

/// Returns the cycles of a serial division in addition to kDivideBaseCycles.
constexpr unsigned divide_extra_unsigned(std::uint32_t divisor) {
  return static_cast<unsigned>(std::countl_zero(divisor));
}
constexpr unsigned divide_extra_signed(std::uint32_t divisor) {
  return static_cast<std::int32_t>(divisor) < 0 ? static_cast<unsigned>(std::countl_one(divisor)) - 1
                                                : divide_extra_unsigned(divisor);
}

/// Returns true if an access touches two words, so that it needs a second bus access.
constexpr bool crosses_word(std::uint32_t address, unsigned size) {
  return (address & 3U) + size > 4;
}

}  // namespace mebots::soc
