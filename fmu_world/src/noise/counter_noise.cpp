// SPDX-License-Identifier: Apache-2.0
#include "noise/counter_noise.hpp"

#include <cmath>
#include <numbers>

namespace mebots::world::noise {
namespace {

/// Converts a word to a number in (0, 1), the middle of one of 2^53 equal cells. The logarithm of the number is finite.
double open_unit(std::uint64_t word) {
  return (static_cast<double>(word >> 11U) + 0.5) * 0x1p-53;
}

}  // namespace

std::uint64_t bits(std::uint64_t seed, Stream stream, std::uint64_t index) {
  return hashed(hashed(hashed(seed) ^ static_cast<std::uint64_t>(stream)) ^ index);
}

double gaussian(std::uint64_t seed, Stream stream, std::uint64_t index) {
  const double radius = std::sqrt(-2.0 * std::log(open_unit(bits(seed, stream, 2 * index))));
  return radius * std::cos(2.0 * std::numbers::pi * open_unit(bits(seed, stream, 2 * index + 1)));
}

}  // namespace mebots::world::noise
