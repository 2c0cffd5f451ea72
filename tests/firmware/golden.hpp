// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nn/network.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace mebots::firmware_test {

/// A picture with the results of the integer network, as defined by examples/paper/training.
struct Golden {
  std::string set;
  std::vector<std::int8_t> picture;
  std::array<int, NN_OUTPUTS> outputs{};     ///< of the network for which this file is compiled
  std::array<std::uint32_t, 7> checksums{};  ///< of each convolution's output
};

/// Returns all golden vectors of the repository. Throws std::runtime_error if their files do not fit each other.
std::vector<Golden> golden_vectors();

/// Returns "output ... checksum ..." in the format of the firmware's check.
std::string text_of(const Golden& golden);

}  // namespace mebots::firmware_test
