// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi2/types.hpp"

#include <string_view>

namespace mebots::fmi2 {

/// As the standard spells it; FMUs may answer anything.
constexpr std::string_view status_name(fmi2Status status) {
  switch (status) {
    case fmi2OK:
      return "fmi2OK";
    case fmi2Warning:
      return "fmi2Warning";
    case fmi2Discard:
      return "fmi2Discard";
    case fmi2Error:
      return "fmi2Error";
    case fmi2Fatal:
      return "fmi2Fatal";
    case fmi2Pending:
      return "fmi2Pending";
  }
  return "a status that FMI 2.0 does not know";
}

}  // namespace mebots::fmi2
