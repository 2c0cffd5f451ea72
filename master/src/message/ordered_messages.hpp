// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "message/message.hpp"

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

namespace mebots::master {

/// Stands between slaves that step at the same time and whoever takes their messages: keeps what is said during a step,
/// and hands it on in the order of the instances. So the log does not depend on the threads.
class OrderedMessages final : public MessageSink {
 public:
  /// `target` must outlive this object.
  explicit OrderedMessages(MessageSink& target) : target_(&target) {}

  /// From any thread.
  void message(const Message& message) override;

  void hold() { holds_ = true; }
  /// Hands on what was kept: first all of the first instance, then all of the second.
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
  bool holds_ = false;  // changed only while no slave steps
  std::vector<Kept> kept_;
};

}  // namespace mebots::master
