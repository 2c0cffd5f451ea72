// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error_code.hpp"

#include <stdexcept>
#include <string>

namespace mebots {

/// The type of all exceptions of the project. The message states the problem, its place (file, instance, variable), the
/// value, and the remedy. Programs distinguish errors by the code. To add context, catch the error and keep its code:
///
///     throw Error(error.code(), place + ": " + error.what());
///
/// In `main` and in the C functions of FMI, guards convert an Error into a status and a message.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& text) : Error(ErrorCode::unspecified, text) {}
  Error(ErrorCode code, const std::string& text) : std::runtime_error(text), code_(code) {}

  ErrorCode code() const noexcept { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace mebots
