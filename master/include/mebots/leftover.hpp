// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace mebots {

/// An FMU that is not clean, and why: "o.fmu: it imports srand(), which changes random numbers".
struct Leftover {
  std::string text;
  bool in_process = false;  ///< it ran in this process, whose next run might find what it left
};

}  // namespace mebots
