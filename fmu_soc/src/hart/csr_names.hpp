// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace mebots::soc::csr {

struct Named {
  unsigned number = 0;
  std::string_view name;
};

/// The registers that every core has and that stand alone, by number.
std::span<const Named> named();
/// "mepc", "mhpmcounter7"; "csr0x7c0" for one without a name here.
std::string name(unsigned number);

}  // namespace mebots::soc::csr
