// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "message/message_hub.hpp"

#include <string>
#include <string_view>

namespace mebots::master {

/// Formats a message for the terminal and log.txt, such as "[   12.345 s] battery: warning: low voltage". The messages
/// of the run itself have no instance: "notice: ...". A message that has several lines is formatted by
/// indented_lines().
std::string message_text(const Message& message);

/// Formats a time, such as "[   12.345 s]".
std::string time_stamp(std::int64_t time_ns);

/// True if the text is well-formed UTF-8 (RFC 3629).
bool is_utf8(std::string_view text);

/// Replaces every byte that is not part of well-formed UTF-8 (RFC 3629) by U+FFFD.
std::string valid_utf8(std::string_view text);

/// Escapes control characters, so that the text is one line and can be printed safely on a terminal. Line feed,
/// carriage return and tab become \n, \r and \t; other characters of C0 and C1 become codes such as \x1b and \u009b.
/// The text must be valid UTF-8.
std::string one_line(std::string_view text);

/// Escapes control characters as one_line() does, but keeps line breaks. Indents each line except the first, so that it
/// does not look like a separate message. Removes empty lines. The text must be valid UTF-8.
std::string indented_lines(std::string_view text);

}  // namespace mebots::master
