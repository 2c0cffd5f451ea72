// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace mebots::app {

/// The arguments that become_python() passes to a command written in Python.
using Words = std::vector<std::string>;

/// Appends an option and its value, unless the value is empty.
inline void add_word(Words& words, const std::string& option, const std::filesystem::path& value) {
  if (!value.empty()) words.insert(words.end(), {option, value.string()});
}

template <typename Number>
void add_number(Words& words, const std::string& option, const std::optional<Number>& value) {
  if (value) words.insert(words.end(), {option, fmt::format("{}", *value)});
}

}  // namespace mebots::app
