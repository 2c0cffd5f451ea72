// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/node.hpp"
#include "mebots/soc/board_device.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <set>
#include <string>
#include <string_view>

namespace mebots::soc {

/// Reads a 32-bit number from a decimal or hexadecimal (0x...) text. Error messages call the number `what`.
std::uint32_t read_number(const data::Node& node, std::string_view what);
std::uint32_t read_address(const data::Node& node);
/// Reads a size in bytes: a multiple of 4, at most 1 GiB.
std::uint32_t read_bytes(const data::Node& node);

/// Returns the name if it is a valid name in C and C++. Otherwise reports it.
std::string checked_name(const data::Node& node, const std::string& name);
std::string read_name(const data::Node& node);

inline auto count_up_to(std::uint32_t most) {
  return [=](const data::Node& node) { return static_cast<std::uint32_t>(node.whole_number(0, most)); };
}

inline auto power_of_two(std::uint32_t least, std::uint32_t most) {
  return [=](const data::Node& node) {
    const auto value = static_cast<std::uint32_t>(node.whole_number(least, most));
    if (!std::has_single_bit(value)) {
      node.fail(ErrorCode::invalid_value, fmt::format("{} must be a power of two from {} to {}", value, least, most));
    }
    return value;
  };
}

/// Returns a reader for names that must be unique in a list. `taken` collects the names of this list.
inline auto new_name(std::set<std::string>& taken) {
  return [&taken](const data::Node& node) {
    auto name = read_name(node);
    if (!taken.insert(name).second) {
      node.fail(ErrorCode::duplicate_name, fmt::format("the name \"{}\" is already used", name));
    }
    return name;
  };
}

/// Reads an entry of a device or a part. Reports keys that such an entry cannot have. `names` contains the names of the
/// previous entries in the same list, and receives the name of this entry.
BoardDevice read_device(const data::Node& node, std::set<std::string>& names);

}  // namespace mebots::soc
