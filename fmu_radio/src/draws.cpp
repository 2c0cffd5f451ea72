// SPDX-License-Identifier: Apache-2.0
#include "draws.hpp"

#include <cmath>
#include <initializer_list>
#include <numbers>

namespace mebots::radio {
namespace {

/// Mixes all bits with the finaliser of MurmurHash3 for 64 bits (Appleby, public domain). The function is a bijection.
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 33U)) * 0xFF51AFD7ED558CCDULL;
  x = (x ^ (x >> 33U)) * 0xC4CEB9FE1A85EC53ULL;
  return x ^ (x >> 33U);
}

double draw(std::int32_t seed, const DrawKey& key, std::uint64_t part) {
  constexpr std::uint64_t kStep = 0x9E3779B97F4A7C15ULL;  // 2^64 divided by the golden ratio
  auto bits = mixed(static_cast<std::uint64_t>(seed) + kStep);
  for (const auto word : {static_cast<std::uint64_t>(key.purpose), key.from, key.to, key.event, part}) {
    bits = mixed((bits ^ word) + kStep);
  }
  // Returns the middle of one of 2^53 equal parts of [0, 1], so that the result is neither 0 nor 1.
  return (static_cast<double>(bits >> 11U) + 0.5) * 0x1p-53;
}

}  // namespace

double uniform(std::int32_t seed, const DrawKey& key) {
  return draw(seed, key, 0);
}

double gaussian(std::int32_t seed, const DrawKey& key) {
  return std::sqrt(-2 * std::log(draw(seed, key, 1))) * std::cos(2 * std::numbers::pi * draw(seed, key, 2));
}

}  // namespace mebots::radio
