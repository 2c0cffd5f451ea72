// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "message/message.hpp"

#include <atomic>
#include <exception>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

namespace mebots::master {

/// Hands every message to all who listen, one message at a time, whichever threads they come from. Messages come out of
/// calls to FMUs, through which nothing may be thrown: what a listener throws is kept until rethrow().
class MessageHub final : public MessageSink {
 public:
  using Listener = std::function<void(const Message&)>;

  /// Not while messages may come.
  void add(Listener listener) { listeners_.push_back(std::move(listener)); }

  void message(const Message& message) override {
    const std::lock_guard lock(mutex_);
    for (const auto& listener : listeners_) {
      try {
        listener(message);
      } catch (...) {
        if (!failure_) failure_ = std::current_exception();
        failed_ = true;
      }
    }
  }

  /// Throws what a listener threw since the last call. For the thread that steps, between two calls to FMUs.
  void rethrow() {
    if (!failed_.load(std::memory_order_relaxed)) return;
    const std::lock_guard lock(mutex_);
    failed_ = false;
    std::rethrow_exception(std::exchange(failure_, nullptr));
  }

 private:
  std::mutex mutex_;
  std::vector<Listener> listeners_;
  std::exception_ptr failure_;
  std::atomic<bool> failed_{false};
};

}  // namespace mebots::master
