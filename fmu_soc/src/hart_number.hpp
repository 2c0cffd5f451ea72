// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace mebots::soc {

// All harts of the chip have a number: 0 is the fabric controller, n + 1 core n of the cluster. Within the cluster a
// core is n. (What mhartid reads there is GAP8's matter.)

inline constexpr unsigned kFabricControllerHart = 0;
/// Among the numbers of the cluster's cores.
inline constexpr int kFabricControllerCore = -1;

constexpr unsigned hart_of_core(int core) {
  return static_cast<unsigned>(core - kFabricControllerCore);
}

/// Of a hart that is not the fabric controller.
constexpr unsigned core_of_hart(unsigned hart) {
  return hart - hart_of_core(0);
}

}  // namespace mebots::soc
