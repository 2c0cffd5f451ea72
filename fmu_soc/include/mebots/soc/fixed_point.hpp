// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

/// Conversions between physical values and device registers, which contain integers in a small unit such as um/s or mV.
namespace mebots::soc {

inline constexpr double kMicro = 1e6;
inline constexpr double kMilli = 1e3;

/// Returns the register word for a value in SI units. A value outside the range of a signed 32-bit integer becomes the
/// nearest limit. NaN becomes 0.
inline std::uint32_t to_register(double value, double units_per_si) {
  const double scaled = std::round(value * units_per_si);
  if (std::isnan(scaled)) return 0;
  if (scaled >= std::numeric_limits<std::int32_t>::max()) return 0x7fffffffU;
  if (scaled <= std::numeric_limits<std::int32_t>::min()) return 0x80000000U;
  return static_cast<std::uint32_t>(static_cast<std::int32_t>(scaled));
}

inline double from_register(std::uint32_t word, double units_per_si) {
  return static_cast<std::int32_t>(word) / units_per_si;
}

}  // namespace mebots::soc
