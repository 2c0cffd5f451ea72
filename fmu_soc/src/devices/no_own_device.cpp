// SPDX-License-Identifier: Apache-2.0
#include "mebots/soc/own_device.hpp"

namespace mebots::soc {

std::unique_ptr<OwnDevice> make_own_device(const BoardDevice& /*entry*/) {
  return nullptr;
}

}  // namespace mebots::soc
