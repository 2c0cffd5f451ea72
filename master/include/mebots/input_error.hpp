// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

namespace mebots {

/// Thrown for an error that the user can correct, for example in the config, in an FMU or on the command line. The
/// program `mebots` then exits with code 2.
class InputError : public Error {
 public:
  using Error::Error;
};

}  // namespace mebots
