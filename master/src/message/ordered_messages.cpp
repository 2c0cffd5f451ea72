// SPDX-License-Identifier: Apache-2.0
#include "message/message_hub.hpp"

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

}  // namespace mebots::master
