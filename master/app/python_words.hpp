// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace mebots::app {

/// The arguments of a command in Python, for become_python().
using Words = std::vector<std::string>;

/// Appends the option and its value if the value is not empty.
inline void add_word(Words& words, const std::string& option, const std::filesystem::path& value) {
  if (!value.empty()) words.insert(words.end(), {option, value.string()});
}

template <typename Number>
void add_number(Words& words, const std::string& option, const std::optional<Number>& value) {
  if (value) words.insert(words.end(), {option, fmt::format("{}", *value)});
}

}  // namespace mebots::app
