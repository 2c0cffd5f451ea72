// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace mebots::soc::tool {

class Console {
 public:
  virtual ~Console() = default;

  virtual void write(std::span<const char> bytes) = 0;
  /// Reads input into `into`. Returns the number of bytes, 0 at the end of the input, or -errno after an error.
  virtual long read(std::span<char> into) = 0;
};

}  // namespace mebots::soc::tool
