// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "nn/network.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace mebots::firmware_test {

/// A picture with what the network in whole numbers, as examples/paper/training defines it, makes of it.
struct Golden {
  std::string set;
  std::vector<std::int8_t> picture;
  std::array<int, NN_OUTPUTS> outputs{};     ///< of the network that the code is compiled for
  std::array<std::uint32_t, 7> checksums{};  ///< of each convolution's output
};

/// All golden vectors of the repository. Throws std::runtime_error if their files do not fit each other.
std::vector<Golden> golden_vectors();

/// "output ... checksum ...", as the firmware's check prints it.
std::string text_of(const Golden& golden);

}  // namespace mebots::firmware_test
