// SPDX-License-Identifier: Apache-2.0
#include "hart/timing.hpp"

#include "mebots/assert.hpp"

#include <array>
#include <cstdint>

namespace mebots::soc {
namespace {

/// Returns true if the field rs1 contains a register. In csr_immediate operations, it contains data. Operations that
/// read no rs1 have x0 there.
bool reads_rs1(Op op) {
  return traits_of(op).kind != OpKind::csr_immediate;
}

/// Returns true if an instruction stalls directly after a load, because it reads or writes the loaded register. Some
/// such writes do not stall. RI5CY also stalls if the offset of a store contains the register's number.
bool load_stall(const Timing& timing, const Previous& load, const Current& current) {
  if (!is_load(load.op) || !load.writes()) return false;
  if (reads_rs1(current.op) && current.rs1 == load.rd) return true;
  if (traits_of(current.op).reads_rs2 && current.rs2 == load.rd) return true;
  if (current.rs3 == load.rd) return true;
  if (is_store(current.op)) {
    // Bits 4:0 of a store's offset are in the field of the word that contains rd in other instructions.
    const bool has_offset = traits_of(current.op).mode == AddressMode::offset;
    return has_offset && timing.store_offset_looks_like_rd() && (static_cast<unsigned>(current.imm) & 31U) == load.rd;
  }
  if (is_branch(current.op) || current.rd != load.rd) return false;
  if (is_post_increment(current.op)) return false;  // measured: RI5CY compares the pointer register instead
  return !is_load(current.op) || timing.load_after_load_stalls();
}

unsigned jump_cycles(const Previous& two_before, const Previous& before, const Current& jump) {
  MEBOTS_ASSERT(is_jump(jump.op));
  const bool needs_pointer = jump.op == Op::jalr && before.pointer() != 0 && jump.rs1 == before.pointer();
  const bool needs_before = jump.op == Op::jalr && before.writes() && jump.rs1 == before.rd;
  if (needs_pointer && !needs_before) return 3;
  if (needs_before) return is_load(before.op) ? 4 : 3;
  if (before.slow()) return 1;  // the jump was fetched while the previous instruction was busy
  const bool needs_two_before =
      jump.op == Op::jalr && is_load(two_before.op) && two_before.writes() && jump.rs1 == two_before.rd;
  return needs_two_before ? 3 : 2;
}

/// Values of the column `pace` of hart/csrs.inc.
enum class Pace : std::uint8_t { quick, slow, slow_always };
struct CsrPace {
  unsigned number;
  unsigned count;
  Pace pace;
};
constexpr auto kCsrPaces = std::to_array<CsrPace>({
#define MEBOTS_CSR(constant, number, count, name, first, core, pace, ...) {number, count, Pace::pace},
#include "hart/csrs.inc"
});

}  // namespace

std::optional<CoreKind> core_kind(std::string_view name) {
  if (name == "cv32e40p") return CoreKind::cv32e40p;
  if (name == "ri5cy") return CoreKind::ri5cy;
  if (name.starts_with("rv32")) return CoreKind::rv32imc;
  return std::nullopt;
}

unsigned Timing::csr_cycles(unsigned number) const {
  for (const auto& row : kCsrPaces) {
    if (number < row.number || number >= row.number + row.count) continue;
    const bool slow = row.pace == Pace::slow_always || (row.pace == Pace::slow && kind != CoreKind::ri5cy);
    return slow ? 4 : 1;
  }
  return 1;
}

unsigned own_cycles(const Timing& timing, const Current& current) {
  MEBOTS_ASSERT(traits_of(current.op).cycles > 0);
  if (is_csr(current.op)) return timing.csr_cycles(static_cast<unsigned>(current.imm));
  return traits_of(current.op).cycles;
}

unsigned static_cycles(const Timing& timing, const Previous& two_before, const Previous& before,
                       const Current& current) {
  if (is_jump(current.op)) {
    const bool overwrites_load =
        is_load(before.op) && before.rd != 0 && !before.slow() && current.rd == before.rd && current.rs1 != before.rd;
    return jump_cycles(two_before, before, current) + (overwrites_load ? 1U : 0U);
  }
  return own_cycles(timing, current) + (load_stall(timing, before, current) ? 1U : 0U);
}

bool overlaps_slow(const Previous& slow, const Current& current) {
  return is_jump(current.op) && jump_cycles({}, slow, current) == 1;
}

unsigned most_extra_cycles(Op op) {
  if (is_load(op) || is_store(op)) return kMisalignedExtra;
  if (is_branch(op)) return kTakenBranchExtra;
  if (is_divide(op)) return 32;
  return 0;
}

}  // namespace mebots::soc
