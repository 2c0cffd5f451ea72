// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace mebots::soc::tool {

/// The console as a program's calls to the host use it: bytes in, bytes out.
class Console {
 public:
  virtual ~Console() = default;

  virtual void write(std::span<const char> bytes) = 0;
  /// Returns the number of bytes read; 0 at the end of the input; -errno after an error.
  virtual long read(std::span<char> into) = 0;
};

}  // namespace mebots::soc::tool
