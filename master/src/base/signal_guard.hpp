// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace mebots::master {

/// While one of these lives, the first SIGINT, SIGTERM or SIGHUP sets the flags of all of them; the second has the
/// effect that it has by default, which ends the process. A signal that the process ignores stays ignored. The last
/// guard to go puts back the handlers that were there, and raises the signal again when a guard asked for that. From
/// any thread. Flags beyond kMost at a time are not set.
class SignalGuard {
 public:
  static constexpr int kMost = 256;
  enum class Afterwards {
    nothing,  ///< the interrupt is all that comes of the signal
    raise,    ///< whoever handled the signal before hears of it, once the last guard is gone
  };

  /// `flag` must outlive the guard.
  explicit SignalGuard(std::atomic<bool>& flag, Afterwards afterwards = Afterwards::nothing);
  ~SignalGuard();
  SignalGuard(const SignalGuard&) = delete;
  SignalGuard& operator=(const SignalGuard&) = delete;

  /// The signal that came while this guard was there; 0 = none.
  int signal() const noexcept;

 private:
  Afterwards afterwards_;
  int slot_ = -1;
};

}  // namespace mebots::master
