// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

/// Numbers of the control and status registers in the table csrs.inc.
namespace mebots::soc::csr {

#define MEBOTS_CSR(constant, number, ...) inline constexpr unsigned k##constant = number;
#include "hart/csrs.inc"

/// Value of mstatus.FS = Dirty. The model only has the states Off and Dirty. A write of Initial or Clean sets Dirty.
inline constexpr std::uint32_t kFloatsOn = 3U << 13;

/// The cores that have the registers of a row. `floats`: cores with F or Zfinx; `user`: cores with U mode; `pmp`: cores
/// with physical memory protection.
enum class Core : std::uint8_t { every, ri5cy, gap8, floats, user, pmp };

/// The register numbers of one row of csrs.inc. Each register has a slot, its index in CsrState::words. The slots of
/// all rows are consecutive.
struct Place {
  unsigned number;  // number of the first register
  unsigned count;
};
inline constexpr auto kPlaces = std::to_array<Place>({
#define MEBOTS_CSR(constant, number, count, ...) {number, count},
#include "hart/csrs.inc"
});

/// Returns the number of registers in all rows before `row`.
constexpr unsigned slots_before(std::size_t row) {
  unsigned slots = 0;
  for (std::size_t i = 0; i < row; ++i) slots += kPlaces[i].count;
  return slots;
}

/// Returns the slot of the register with this number, or the number of all slots if no row contains it.
constexpr unsigned slot_of(unsigned number) {
  unsigned slots = 0;
  for (const auto& place : kPlaces) {
    if (number >= place.number && number < place.number + place.count) return slots + (number - place.number);
    slots += place.count;
  }
  return slots;
}

struct Named {
  unsigned number = 0;
  std::string_view name;
};

/// Returns the registers that every core has, sorted by number. Excludes rows with several registers.
std::span<const Named> named();
/// Returns the name of a register, such as "mepc" or "mhpmcounter7". A number without a row is called "csr0x7c0".
std::string name(unsigned number);

}  // namespace mebots::soc::csr

/// Values of mcause. Source: The RISC-V Instruction Set Manual, volume II, table 3.6.
namespace mebots::soc::cause {

inline constexpr unsigned kFetchAccess = 1;
inline constexpr unsigned kIllegalInstruction = 2;
inline constexpr unsigned kBreakpoint = 3;
inline constexpr unsigned kLoadMisaligned = 4;
inline constexpr unsigned kLoadAccess = 5;
inline constexpr unsigned kStoreMisaligned = 6;
inline constexpr unsigned kStoreAccess = 7;
inline constexpr unsigned kUserEcall = 8;
inline constexpr unsigned kMachineEcall = 11;
inline constexpr unsigned kInterrupt = 0x80000000U;

}  // namespace mebots::soc::cause
