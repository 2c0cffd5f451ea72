// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

namespace mebots {

/// Thrown if MEbots cannot use an input of the user, such as a call, the command line, the config, an FMU, a start
/// value or the results folder. The program `mebots` then exits with code 2.
class InputError : public Error {
 public:
  using Error::Error;
};

}  // namespace mebots
