// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error_code.hpp"

#include <stdexcept>
#include <string>

namespace mebots {

/// The one error type. Its text says what is wrong, where (file, instance, variable), the offending value and the way
/// out; its code says the same to programs. Who catches one to say more keeps the code:
///
///     throw Error(error.code(), place + ": " + error.what());
///
/// Guards at the C boundary and in `main` turn it into a status and a message.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& text) : Error(ErrorCode::unspecified, text) {}
  Error(ErrorCode code, const std::string& text) : std::runtime_error(text), code_(code) {}

  ErrorCode code() const noexcept { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace mebots
