// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "message/message_hub.hpp"

#include <string>
#include <string_view>

namespace mebots::master {

/// Formats a message for the terminal and log.txt, such as "[   12.345 s] battery: warning: low voltage". Messages of
/// the run have no instance: "notice: ...". Uses indented_lines() for a message of several lines.
std::string message_text(const Message& message);

/// Formats a time, such as "[   12.345 s]".
std::string time_stamp(std::int64_t time_ns);

bool is_utf8(std::string_view text);

/// Replaces all bytes that are not valid UTF-8 (RFC 3629) by U+FFFD.
std::string valid_utf8(std::string_view text);

/// Escapes control characters, so that the text is a single line and safe for a terminal. Line feed, carriage return
/// and tab become \n, \r and \t. Other characters of C0 and C1 become codes such as \x1b and \u009b. The text must be
/// valid UTF-8.
std::string one_line(std::string_view text);

/// Escapes control characters like one_line(), but keeps line breaks. Removes empty lines. Indents all lines except the
/// first, so that they do not look like separate messages. The text must be valid UTF-8.
std::string indented_lines(std::string_view text);

}  // namespace mebots::master
