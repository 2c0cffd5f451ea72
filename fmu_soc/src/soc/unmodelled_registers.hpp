// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/board_device.hpp"

#include <cstdint>
#include <set>
#include <string>
#include <string_view>

namespace mebots::soc {

/// Accesses of GAP8's programs to registers that no device of the board has. RI5CY of 2018 knows no access fault: such
/// a load reads something, here 0, such a store is lost, and the program goes on. Each address is told once, for it may
/// be why a program does something else than on the chip. Not part of a state.
class UnmodelledRegisters {
 public:
  /// Whether GAP8 has peripherals there; elsewhere an access is a fault.
  static bool are_at(std::uint32_t address);

  /// `entry`: the device whose addresses these are; null = none.
  std::string text(std::uint32_t address, bool stores, std::string_view function, const BoardDevice* entry) const;
  /// True for the first access to an address.
  bool is_new(std::uint32_t address);

 private:
  std::set<std::uint32_t> told_;
};

}  // namespace mebots::soc
