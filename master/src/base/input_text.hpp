// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/input_error.hpp"
#include "mebots/text_file.hpp"

namespace mebots::master {

/// The whole content of a file that the user named. Throws InputError.
inline std::string input_text(const std::filesystem::path& file) {
  try {
    return text_of(file);
  } catch (const Error& error) {
    throw InputError(error.what());
  }
}

}  // namespace mebots::master
