// SPDX-License-Identifier: Apache-2.0
#include "board/readers.hpp"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <system_error>

namespace mebots::soc {

std::uint32_t read_number(const data::Node& node, std::string_view what) {
  const auto text = node.text();
  const bool is_hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  const auto digits = std::string_view(text).substr(is_hexadecimal ? 2 : 0);
  // A leading zero marks octal numbers in C, and decimal numbers elsewhere.
  const bool is_ambiguous = !is_hexadecimal && digits.size() > 1 && digits.front() == '0';
  std::uint32_t value = 0;
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), value, is_hexadecimal ? 16 : 10);
  if (error != std::errc{} || end != digits.data() + digits.size() || is_ambiguous) {
    node.fail(
        ErrorCode::invalid_value,
        fmt::format("\"{}\" must be a 32-bit {} such as \"0x1A188000\", or decimal without leading zeros", text, what));
  }
  return value;
}

std::uint32_t read_address(const data::Node& node) {
  const auto value = read_number(node, "address");
  if (value % 4 != 0) {
    node.fail(ErrorCode::invalid_value, fmt::format("\"{}\" must be a multiple of 4", node.text()));
  }
  return value;
}

std::string checked_name(const data::Node& node, const std::string& name) {
  bool good = !name.empty() && std::isalpha(static_cast<unsigned char>(name[0])) != 0;
  for (const char c : name) good = good && (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_');
  if (!good) {
    node.fail(ErrorCode::invalid_value,
              fmt::format("the name \"{}\" must be letters, digits and '_', a letter first", name));
  }
  return name;
}

std::string read_name(const data::Node& node) {
  return checked_name(node, node.text());
}

std::uint32_t read_bytes(const data::Node& node) {
  const auto size = static_cast<std::uint32_t>(node.whole_number(4, 1U << 30));
  if (size % 4 != 0) node.fail(ErrorCode::invalid_value, "the size must be a multiple of 4");
  return size;
}

}  // namespace mebots::soc
