// SPDX-License-Identifier: Apache-2.0
#include "fmi/call/float_environment.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <vector>

namespace mebots::master {

// Intel 64 and IA-32 Architectures Software Developer's Manual, volume 1: figures 10-3 (MXCSR) and 8-6 (control word).
std::string difference_text(const FloatEnvironment& found, const FloatEnvironment& wanted) {
  constexpr std::array kRounding = {"to nearest", "downward", "upward", "toward zero"};
  constexpr std::uint32_t kTraps = 0x1f80;
  constexpr std::uint32_t kFlushToZero = 0x8000;
  constexpr std::uint32_t kDenormalsAreZero = 0x0040;
  const auto rounding = [](const FloatEnvironment& environment) { return (environment.mxcsr >> 13) & 3; };
  const auto differs = [&](std::uint32_t bits) { return ((found.mxcsr ^ wanted.mxcsr) & bits) != 0; };
  std::vector<std::string> parts;
  if (rounding(found) != rounding(wanted)) parts.push_back(fmt::format("rounding {}", kRounding[rounding(found)]));
  if (differs(kFlushToZero | kDenormalsAreZero)) {
    parts.emplace_back((found.mxcsr & (kFlushToZero | kDenormalsAreZero)) != 0 ? "denormal numbers become 0"
                                                                               : "denormal numbers stay");
  }
  if (differs(kTraps)) parts.emplace_back("exceptions end the process");
  if (found.x87 != wanted.x87) {
    parts.push_back(fmt::format("x87 control word {:#06x} instead of {:#06x}", found.x87, wanted.x87));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace mebots::master
