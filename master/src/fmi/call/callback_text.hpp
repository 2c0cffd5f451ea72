// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

/// Texts that foreign code hands to a callback. Nothing about them is believed: a pointer may lead nowhere, a format
/// may ask for arguments that are not there.
namespace mebots::master {

/// Longer texts are cut.
inline constexpr std::size_t kLongestText = std::size_t{64} * 1024;

/// The bytes from `address` up to a zero or `most`. Nothing for null and for memory that cannot be read: the kernel
/// copies, so that an address that leads nowhere is an answer and not a signal.
std::optional<std::string> read_text(const char* address, std::size_t most = kLongestText);

/// Returns false if a part of it cannot be read. Where the system does not say, true.
bool is_readable(std::span<const std::uint8_t> bytes);

/// As vsnprintf, for a format that may not fit its arguments. %n writes nothing, a %s that points nowhere becomes
/// "(unreadable)", widths and precisions are bounded. Arguments that are missing or of other types give wrong numbers:
/// the language lets nobody see that. After 100 conversions, or one that is not known, the rest stands as it is.
std::string format_text(const std::string& format, std::va_list arguments);

}  // namespace mebots::master
