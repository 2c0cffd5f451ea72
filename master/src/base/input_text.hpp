// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/input_error.hpp"
#include "mebots/text_file.hpp"

namespace mebots::master {

/// What `read` returns; whatever it throws is an InputError.
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

/// The whole content of a file that the user named. Throws InputError.
inline std::string input_text(const std::filesystem::path& file) {
  return refused_as_input([&] { return text_of(file); });
}

}  // namespace mebots::master
