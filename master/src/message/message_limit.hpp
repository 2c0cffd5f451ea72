// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <optional>
#include <string>
#include <utility>

namespace mebots::master {

/// Bounds the messages that one call to an FMU may leave behind, and counts those beyond. Not for two threads at once.
class MessageLimit {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{32} << 20;

  explicit MessageLimit(std::size_t most_bytes = kMostBytes) : most_bytes_(most_bytes) {}

  /// Returns whether a message with this much text is still kept; counts it as dropped if not.
  bool take(std::size_t text_bytes) {
    constexpr std::size_t kFrameBytes = 64;
    if (bytes_ + text_bytes + kFrameBytes > most_bytes_) {
      ++dropped_;
      return false;
    }
    bytes_ += text_bytes + kFrameBytes;
    return true;
  }

  /// Begins anew. Returns a notice if messages were dropped.
  std::optional<std::string> restart() {
    bytes_ = 0;
    const auto dropped = std::exchange(dropped_, 0);
    if (dropped == 0) return std::nullopt;
    return fmt::format("{} more messages of this call were dropped: one call may leave {} MiB of messages", dropped,
                       most_bytes_ >> 20);
  }

 private:
  std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  std::size_t dropped_ = 0;
};

}  // namespace mebots::master
