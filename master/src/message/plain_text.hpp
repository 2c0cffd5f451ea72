// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace mebots::master {

/// Returns whether the text is well-formed UTF-8 (RFC 3629).
bool is_utf8(std::string_view text);

/// The text with every byte that is not part of well-formed UTF-8 (RFC 3629) replaced by U+FFFD.
std::string valid_utf8(std::string_view text);

/// The text on one line, without anything that a terminal acts on. Line feed, carriage return and tab become \n, \r and
/// \t, other control characters of C0 and C1 become \x1b, \u009b and the like. Takes valid UTF-8.
std::string one_line(std::string_view text);

}  // namespace mebots::master
