// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace mebots::soc {

inline constexpr std::uint64_t kSplitMixStep = 0x9e3779b97f4a7c15U;

/// Returns a number in [0, 1), computed from the output of splitmix64 for `state` (Steele, Lea and Flood 2014).
/// Consecutive states differ by `kSplitMixStep`.
constexpr double uniform_number(std::uint64_t state) {
  state = (state ^ (state >> 30)) * 0xbf58476d1ce4e5b9U;
  state = (state ^ (state >> 27)) * 0x94d049bb133111ebU;
  return static_cast<double>((state ^ (state >> 31)) >> 11) * 0x1p-53;
}

/// Each `index` has `count` random numbers, which depend only on `seed` and `index`. Returns the state for the first of
/// them.
constexpr std::uint64_t random_state(std::uint64_t seed, std::uint64_t index, unsigned count) {
  return seed * 0xd1342543de82ef95U + index * count * kSplitMixStep + kSplitMixStep;
}

}  // namespace mebots::soc
