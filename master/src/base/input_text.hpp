// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/input_error.hpp"
#include "mebots/text_file.hpp"

namespace mebots::master {

/// Calls `read` and returns its result. Converts Error to InputError.
template <typename Read>
auto refused_as_input(const Read& read) {
  try {
    return read();
  } catch (const InputError&) {
    throw;
  } catch (const Error& error) {
    throw InputError(error.code(), error.what());
  }
}

/// Returns the content of a file of the user. Throws InputError if the file cannot be read.
inline std::string input_text(const std::filesystem::path& file) {
  return refused_as_input([&] { return text_of(file); });
}

}  // namespace mebots::master
