// SPDX-License-Identifier: Apache-2.0
#include "message/message_text.hpp"

#include "base/time.hpp"

#include <fmt/format.h>

namespace mebots::master {
namespace {

std::string_view prefix_of(Severity severity) {
  switch (severity) {
    case Severity::info:
      break;
    case Severity::warning:
      return "warning: ";
    case Severity::error:
      return "error: ";
  }
  return "";
}

}  // namespace

std::string time_stamp(std::int64_t time_ns) {
  return fmt::format("[{:>9.3f} s]", to_seconds(time_ns));
}

std::string message_text(const Message& message) {
  if (message.instance.empty()) {
    return fmt::format("{}{}", message.severity == Severity::info ? "notice: " : prefix_of(message.severity),
                       one_line(message.text));
  }
  return fmt::format("{} {}: {}{}", time_stamp(message.time_ns), message.instance, prefix_of(message.severity),
                     one_line(message.text));
}

}  // namespace mebots::master
