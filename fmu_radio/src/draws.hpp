// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// Computes random numbers as functions of the seed and a DrawKey. A number does not depend on earlier draws or on
/// other nodes, so that no state must be saved.
namespace mebots::radio {

enum class Purpose : std::uint64_t { packet = 1, ranging_loss, ranging_noise, fix_loss, fix_noise };

/// Selects a random number. `from` is a node. `to` is another node, an axis, or 0. `event` is the number of the node's
/// packet, request or sample.
struct DrawKey {
  Purpose purpose;
  std::uint64_t from;
  std::uint64_t to;
  std::uint64_t event;
};

/// Returns a uniformly distributed number in (0, 1).
double uniform(std::int32_t seed, const DrawKey& key);

/// Returns a normally distributed number with mean 0 and standard deviation 1 (Box and Muller 1958).
double gaussian(std::int32_t seed, const DrawKey& key);

}  // namespace mebots::radio
