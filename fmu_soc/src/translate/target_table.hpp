// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace mebots::soc::translate {

/// Code of the last known targets of indirect jumps, looked up by translated code.
struct TargetTable {
  static constexpr std::uint32_t kStep = 2;  // bytes of a pc per entry
  static constexpr std::uint32_t kMask = 0x7fe;

  struct Target {
    std::uint32_t pc = kNone;
    std::uint32_t unused = 0;
    const std::uint8_t* code = nullptr;
  };

  void clear() { targets = {}; }
  void set(std::uint32_t pc, const std::uint8_t* code) { targets[(pc & kMask) / kStep] = {pc, 0, code}; }

  static constexpr std::uint32_t kNone = 1;  // no pc is odd
  std::array<Target, kMask / kStep + 1> targets{};
};

}  // namespace mebots::soc::translate
