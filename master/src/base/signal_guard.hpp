// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace mebots::master {

/// While one of these lives, the first SIGINT, SIGTERM or SIGHUP sets the flags of all of them; the second has the
/// effect that it has by default, which ends the process. The last one to go puts back the handlers that were there.
/// From any thread. A process has room for kMost; flags beyond that are not set.
class SignalGuard {
 public:
  static constexpr int kMost = 256;

  /// `flag` must outlive the guard.
  explicit SignalGuard(std::atomic<bool>& flag);
  ~SignalGuard();
  SignalGuard(const SignalGuard&) = delete;
  SignalGuard& operator=(const SignalGuard&) = delete;

  /// The signal that came while any guard was there; 0 = none.
  static int signal() noexcept;

 private:
  int slot_ = -1;
};

}  // namespace mebots::master
