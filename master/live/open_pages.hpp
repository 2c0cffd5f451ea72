// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>

namespace mebots::live {

/// The open pages that have not yet received the end of the run. Thread-safe.
class OpenPages {
 public:
  using Clock = std::chrono::steady_clock;

  /// Records a request of a page. Ignores late requests of removed pages, and new pages above the limit.
  void note_request(const std::string& page) {
    constexpr std::size_t kMost = 32;
    const std::lock_guard lock(mutex_);
    const auto known = last_requests_.find(page);
    if (known != last_requests_.end()) {
      if (known->second != kRemoved) known->second = Clock::now();
      return;
    }
    if (last_requests_.size() >= kMost)
      std::erase_if(last_requests_, [](const auto& one) { return one.second == kRemoved; });
    if (last_requests_.size() < kMost) last_requests_.emplace(page, Clock::now());
  }
  /// Removes a page that was closed or has received the end of the run.
  void remove(const std::string& page) {
    const std::lock_guard lock(mutex_);
    if (const auto known = last_requests_.find(page); known != last_requests_.end()) known->second = kRemoved;
  }
  /// True if an open page sent a request after `time`.
  bool any_since(Clock::time_point time) const {
    const std::lock_guard lock(mutex_);
    return std::ranges::any_of(last_requests_, [&](const auto& page) { return page.second > time; });
  }

 private:
  static constexpr Clock::time_point kRemoved = Clock::time_point::min();

  mutable std::mutex mutex_;
  std::map<std::string, Clock::time_point> last_requests_;
};

}  // namespace mebots::live
