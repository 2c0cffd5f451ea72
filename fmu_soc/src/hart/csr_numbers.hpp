// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

/// Numbers of the control and status registers, from their table.
namespace mebots::soc::csr {

#define MEBOTS_CSR(constant, number, ...) inline constexpr unsigned k##constant = number;
#include "hart/csrs.inc"

/// Which cores have the registers of a row.
enum class Core : std::uint8_t { every, ri5cy, gap8 };

/// Where the registers of a row stand among all, one behind the other in the order of the table.
struct Place {
  unsigned number;  // of its first one
  unsigned count;
};
inline constexpr auto kPlaces = std::to_array<Place>({
#define MEBOTS_CSR(constant, number, count, ...) {number, count},
#include "hart/csrs.inc"
});

/// How many stand before row `row`; before the end: all of them.
constexpr unsigned slots_before(std::size_t row) {
  unsigned slots = 0;
  for (std::size_t i = 0; i < row; ++i) slots += kPlaces[i].count;
  return slots;
}

/// The place of the first register with this number; behind all when there is none.
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

/// The registers that every core has and that stand alone, by number.
std::span<const Named> named();
/// "mepc", "mhpmcounter7"; "csr0x7c0" for one without a name here.
std::string name(unsigned number);

}  // namespace mebots::soc::csr

/// Values of mcause. Source: The RISC-V Instruction Set Manual, volume II, table 3.6.
namespace mebots::soc::cause {

inline constexpr unsigned kFetchAccess = 1;
inline constexpr unsigned kIllegalInstruction = 2;
inline constexpr unsigned kBreakpoint = 3;
inline constexpr unsigned kLoadAccess = 5;
inline constexpr unsigned kStoreAccess = 7;
inline constexpr unsigned kMachineEcall = 11;
inline constexpr unsigned kInterrupt = 0x80000000U;

}  // namespace mebots::soc::cause
