// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace mebots {

/// Converts a text to a number. Returns empty if the text contains anything else, or if T cannot hold the number. The
/// text has the form of std::from_chars: a plus sign and spaces are not permitted.
template <typename T>
std::optional<T> parsed_number(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace mebots
