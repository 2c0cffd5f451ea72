// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace mebots::training {

/// Draws the same random numbers on every machine, unlike std::uniform_real_distribution.
class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}

  double unit() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }
  double between(double low, double high) { return low + (high - low) * unit(); }
  /// Returns a uniformly distributed whole number from 0 to count - 1.
  int below(int count) { return static_cast<int>(unit() * count); }
  bool chance(double probability) { return unit() < probability; }
  /// Returns a number with a uniformly distributed logarithm.
  double log_between(double low, double high) { return low * std::pow(high / low, unit()); }
  /// Returns a normally distributed number with mean 0. Rejects numbers beyond three standard deviations.
  double normal(double deviation) {
    for (;;) {
      const double x = std::sqrt(-2.0 * std::log(1.0 - unit())) * std::cos(2.0 * M_PI * unit());
      if (std::abs(x) <= 3.0) return deviation * x;
    }
  }
  std::uint32_t word() { return static_cast<std::uint32_t>(bits_() >> 32); }

 private:
  std::mt19937_64 bits_;
};

}  // namespace mebots::training
