// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace mebots::world::camera {

/// Weyl increment of SplitMix64.
inline constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15ULL;

/// One output of SplitMix64 (Steele, Lea, Flood 2014) for the state `x`: a bijection that leaves no trace of
/// the order in its input. Stateless, so that any pixel's or lattice point's value is known on its own.
constexpr std::uint64_t hashed(std::uint64_t x) {
  x += kGolden;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

}  // namespace mebots::world::camera
