// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>

namespace mebots::live {

/// The pages that are open and have not received the end of the run. May be used from any thread.
class OpenPages {
 public:
  using Clock = std::chrono::steady_clock;

  /// Notes a request of a page. If there are too many pages, ignores a new one.
  void note_request(const std::string& page) {
    constexpr std::size_t kMost = 32;
    const std::lock_guard lock(mutex_);
    if (last_requests_.size() < kMost || last_requests_.contains(page)) last_requests_[page] = Clock::now();
  }
  /// Removes a page, because it has closed or has received the end.
  void remove(const std::string& page) {
    const std::lock_guard lock(mutex_);
    last_requests_.erase(page);
  }
  /// Returns true if one of these pages sent a request after `time`.
  bool any_since(Clock::time_point time) const {
    const std::lock_guard lock(mutex_);
    return std::ranges::any_of(last_requests_, [&](const auto& page) { return page.second > time; });
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, Clock::time_point> last_requests_;
};

}  // namespace mebots::live
