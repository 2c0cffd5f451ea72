// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// Numbers and bytes as gdb's remote protocol writes them.
namespace mebots::soc::debug {

struct Range {
  std::uint32_t address = 0;
  std::uint32_t size = 0;
};

/// "1c000000"; nothing when it is empty, no number, or longer than 32 bits.
std::optional<std::uint32_t> parse_hex(std::string_view text);
/// "1c000000,4"
std::optional<Range> parse_range(std::string_view text);
/// Four bytes in the order of memory.
std::optional<std::uint32_t> parse_little_endian(std::string_view text);
std::string little_endian(std::uint32_t value);

std::string to_hex(std::string_view bytes);
std::optional<std::string> from_hex(std::string_view text);

}  // namespace mebots::soc::debug
