// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "message/message.hpp"

#include <functional>
#include <mutex>
#include <vector>

namespace mebots::master {

/// Hands every message to all who listen, one message at a time, whichever threads they come from.
class MessageHub final : public MessageSink {
 public:
  using Listener = std::function<void(const Message&)>;

  /// Not while messages may come.
  void add(Listener listener) { listeners_.push_back(std::move(listener)); }

  void message(const Message& message) override {
    const std::lock_guard lock(mutex_);
    for (const auto& listener : listeners_) listener(message);
  }

 private:
  std::mutex mutex_;
  std::vector<Listener> listeners_;
};

}  // namespace mebots::master
