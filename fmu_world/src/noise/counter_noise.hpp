// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// Noise without a memory: a sample is a function of (seed, stream, index) alone, so that restoring a
/// state, splitting a step or running beside other instances cannot shift it.
namespace mebots::world::noise {

/// Which sensor a number belongs to; two streams of one seed have nothing in common.
enum class Stream : std::uint64_t { range = 1, camera = 2, gust = 3, imu = 4, imu_bias = 5, flow = 6 };

/// 64 well-mixed bits: one SplitMix64 per word of the key.
std::uint64_t bits(std::uint64_t seed, Stream stream, std::uint64_t index);

/// A sample of the normal distribution with mean 0 and standard deviation 1 (Box and Muller 1958).
double gaussian(std::uint64_t seed, Stream stream, std::uint64_t index);

}  // namespace mebots::world::noise
