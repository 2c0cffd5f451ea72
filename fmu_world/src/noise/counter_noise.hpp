// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// Stateless noise: a sample depends only on (seed, stream, index). Therefore restored states, divided steps and other
/// instances do not change it.
namespace mebots::world::noise {

/// The purpose for which a number is drawn. `drone` gives the seed of each drone except the first drone. Two streams
/// with the same seed are independent.
enum class Stream : std::uint64_t {
  range = 1,
  camera = 2,
  gust = 3,
  imu = 4,
  imu_bias = 5,
  flow = 6,
  drone = 7,
  multiranger = 8,
  barometer = 9,
  barometer_bias = 10,
  magnetometer = 11,
  magnetometer_bias = 12,
  contact = 13,
  depth = 14
};

/// The increment of SplitMix64's Weyl sequence.
inline constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15ULL;

/// Returns one output of SplitMix64 (Steele, Lea, Flood 2014) for the state `x`: a bijection whose outputs look random
/// even for consecutive inputs.
constexpr std::uint64_t hashed(std::uint64_t x) {
  x += kGolden;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

/// Returns 64 bits that depend only on seed, stream and index. Applies SplitMix64 once for each of the three.
std::uint64_t bits(std::uint64_t seed, Stream stream, std::uint64_t index);

/// Returns a sample of the normal distribution with mean 0 and standard deviation 1 (Box and Muller 1958).
double gaussian(std::uint64_t seed, Stream stream, std::uint64_t index);

}  // namespace mebots::world::noise
