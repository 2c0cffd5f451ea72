// SPDX-License-Identifier: Apache-2.0
#include "debug/target.hpp"

#include <fmt/core.h>

#include <charconv>

namespace mebots::soc::debug {

std::optional<std::uint32_t> parse_hex(std::string_view text) {
  std::uint32_t value = 0;
  const auto* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value, 16);
  if (error != std::errc() || stopped != end) return std::nullopt;
  return value;
}

std::optional<Range> parse_range(std::string_view text) {
  const auto comma = text.find(',');
  if (comma == std::string_view::npos) return std::nullopt;
  const auto address = parse_hex(text.substr(0, comma));
  const auto size = parse_hex(text.substr(comma + 1));
  if (!address || !size) return std::nullopt;
  return Range{*address, *size};
}

std::optional<std::uint32_t> parse_little_endian(std::string_view text) {
  if (text.size() != 8) return std::nullopt;
  const auto value = parse_hex(text);
  if (!value) return std::nullopt;
  return __builtin_bswap32(*value);
}

std::string little_endian(std::uint32_t value) {
  return fmt::format("{:08x}", __builtin_bswap32(value));
}

std::string to_hex(std::string_view bytes) {
  std::string text;
  for (const char byte : bytes) text += fmt::format("{:02x}", static_cast<std::uint8_t>(byte));
  return text;
}

std::optional<std::string> from_hex(std::string_view text) {
  if (text.size() % 2 != 0) return std::nullopt;
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); i += 2) {
    const auto value = parse_hex(text.substr(i, 2));
    if (!value) return std::nullopt;
    bytes += static_cast<char>(*value);
  }
  return bytes;
}

}  // namespace mebots::soc::debug
