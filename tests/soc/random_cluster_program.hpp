// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace mebots::soc::test {

/// Returns assembly text of an endless program for the fabric controller and any number of the cluster's cores. Random
/// routines, called in random order, compute, branch, loop, load and store in L1 and L2, change each other's code,
/// trap, copy with the DMA, and wait at barriers and for events. The fabric controller runs such code, too, and changes
/// clocks, sleeps, and switches the cluster off and on. The same seed gives the same text.
std::string random_cluster_program(std::uint32_t seed);

}  // namespace mebots::soc::test
