// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace mebots {

/// The one error type. Its text says what is wrong, where (file, instance, variable), the offending
/// value and the way out. Guards at the C boundary and in `main` turn it into a status and a message.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace mebots
