// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/message.hpp"

#include <fmt/format.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master {

/// Receives the messages of FMUs and of the run.
class MessageSink {
 public:
  virtual ~MessageSink() = default;
  virtual void message(const Message& message) = 0;
};

/// Delivers each message to all listeners, one message at a time. May be called from any thread. FMUs send messages
/// during calls, and a C++ exception must not pass through an FMU. If a listener throws, the exception is stored for
/// rethrow().
class MessageHub final : public MessageSink {
 public:
  using Listener = std::function<void(const Message&)>;

  /// Adds a listener. Must not be called while messages may arrive.
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

  /// Throws the first stored exception of a listener, if any. The stepping thread must call rethrow() between two calls
  /// to FMUs.
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

/// Stores the messages of slaves that step in parallel, and delivers them after the step in the order of the instances.
/// The order of the log therefore does not depend on the number of threads.
class OrderedMessages final : public MessageSink {
 public:
  /// `target` must outlive this object.
  explicit OrderedMessages(MessageSink& target) : target_(&target) {}

  /// May be called from any thread.
  void message(const Message& message) override;

  void hold() { holds_ = true; }
  /// Delivers all stored messages in the order of `instances`.
  void release(const std::vector<std::string>& instances);

 private:
  struct Kept {
    std::string instance;
    Severity severity;
    std::string category;
    std::string text;
    std::int64_t time_ns;
  };

  MessageSink* target_;
  std::mutex mutex_;
  bool holds_ = false;  // must change only while no slave is stepping
  std::vector<Kept> kept_;
};

/// Limits the size of all messages during one call to an FMU, and counts the dropped messages. Not thread-safe.
class MessageLimit {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{32} << 20;

  explicit MessageLimit(std::size_t most_bytes = kMostBytes) : most_bytes_(most_bytes) {}

  /// Returns true if a message of this length is accepted. Otherwise, counts the message as dropped.
  bool take(std::size_t text_bytes) {
    constexpr std::size_t kFrameBytes = 64;
    if (bytes_ + text_bytes + kFrameBytes > most_bytes_) {
      ++dropped_;
      return false;
    }
    bytes_ += text_bytes + kFrameBytes;
    return true;
  }

  /// Resets the counts for the next call to an FMU. Returns a notice if messages were dropped.
  std::optional<std::string> restart() {
    bytes_ = 0;
    const auto dropped = std::exchange(dropped_, 0);
    if (dropped == 0) return std::nullopt;
    return fmt::format("{} more messages of this call were dropped: one call may log at most {} MiB", dropped,
                       most_bytes_ >> 20);
  }

 private:
  std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  std::size_t dropped_ = 0;
};

}  // namespace mebots::master
