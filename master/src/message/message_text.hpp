// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "message/message.hpp"

#include <string>

namespace mebots::master {

/// "[   12.345 s] battery: warning: low voltage", the line of a message on the terminal and in log.txt. What the run
/// itself says has no instance: "notice: ...". One line, whatever the FMU said: control characters are escaped.
std::string message_text(const Message& message);

/// "[   12.345 s]"
std::string time_stamp(std::int64_t time_ns);

}  // namespace mebots::master
