// SPDX-License-Identifier: Apache-2.0
#include "message/message_hub.hpp"

#include "base/time.hpp"
#include "message/message_text.hpp"

#include <fmt/format.h>

namespace mebots::master {

void OrderedMessages::message(const Message& message) {
  if (!holds_) {
    target_->message(message);
    return;
  }
  const std::lock_guard lock(mutex_);
  kept_.push_back({std::string(message.instance), message.severity, std::string(message.category),
                   std::string(message.text), message.time_ns});
}

void OrderedMessages::release(const std::vector<std::string>& instances) {
  holds_ = false;
  if (kept_.empty()) return;
  const auto kept = std::move(kept_);
  kept_.clear();
  for (const auto& instance : instances)
    for (const auto& message : kept)
      if (message.instance == instance)
        target_->message({message.instance, message.severity, message.category, message.text, message.time_ns});
}

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
                       indented_lines(message.text));
  }
  return fmt::format("{} {}: {}{}", time_stamp(message.time_ns), message.instance, prefix_of(message.severity),
                     indented_lines(message.text));
}

}  // namespace mebots::master
