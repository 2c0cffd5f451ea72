// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// Noise without a memory: a sample is a function of (seed, stream, index) alone, so that restoring a
/// state, splitting a step or running beside other instances cannot shift it.
namespace mebots::world::noise {

/// Which sensor a number belongs to; two streams of one seed have nothing in common.
enum class Stream : std::uint64_t { range = 1, camera = 2, gust = 3, imu = 4, imu_bias = 5, flow = 6 };

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

/// 64 well-mixed bits: one SplitMix64 per word of the key.
std::uint64_t bits(std::uint64_t seed, Stream stream, std::uint64_t index);

/// A sample of the normal distribution with mean 0 and standard deviation 1 (Box and Muller 1958).
double gaussian(std::uint64_t seed, Stream stream, std::uint64_t index);

}  // namespace mebots::world::noise
