// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

/// Converts bytes to and from pairs of hexadecimal digits, as FMI 3.0 writes start values of type Binary.
namespace mebots {

/// Returns a text such as "0a1bff".
inline std::string hexadecimal(std::string_view bytes) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  text.reserve(2 * bytes.size());
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 15U];
  }
  return text;
}

/// Converts hexadecimal digits to bytes. White space may separate the digits. Returns empty if the text contains any
/// other character.
inline std::optional<std::string> bytes_of_hexadecimal(std::string_view text) {
  const auto value_of = [](char c) -> int {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
  };
  std::string bytes;
  int high = -1;
  for (const char c : text) {
    if (c == ' ' || c == '\t' || c == '\r' || c == '\n') continue;
    const int value = value_of(c);
    if (value < 0) return std::nullopt;
    if (high < 0) {
      high = value;
    } else {
      bytes += static_cast<char>(16 * high + value);
      high = -1;
    }
  }
  return high < 0 ? std::optional(bytes) : std::nullopt;
}

}  // namespace mebots
