// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace mebots::master {

/// Sets a flag on SIGINT, SIGTERM or SIGHUP. The first signal sets the flags of all guards that exist; the second
/// signal ends the process. A signal that the process ignores stays ignored. The destructor of the last guard restores
/// the previous signal handlers. It raises the signal again if a guard has requested Afterwards::raise. Thread-safe. If
/// more than kMost guards exist, the flags of the additional guards are not set.
class SignalGuard {
 public:
  static constexpr int kMost = 256;
  enum class Afterwards {
    nothing,  ///< the signal only sets the flag
    raise,    ///< the last destructor raises the signal again for the previous handler
  };

  /// `flag` must outlive the guard.
  explicit SignalGuard(std::atomic<bool>& flag, Afterwards afterwards = Afterwards::nothing);
  ~SignalGuard();
  SignalGuard(const SignalGuard&) = delete;
  SignalGuard& operator=(const SignalGuard&) = delete;

  /// Returns the signal that was received while this guard existed; 0 if there was none.
  int signal() const noexcept;

 private:
  Afterwards afterwards_;
  int slot_ = -1;
};

/// Thrown after an interrupt by the user. The run ends at the last communication point that all instances have reached.
class InterruptedError : public Error {
 public:
  /// `what_else` describes further effects of the interrupt, such as a killed process.
  explicit InterruptedError(const std::string& what_else = "") : Error(ErrorCode::interrupted, what_else) {}
};

/// A flag that is always false, for runs that cannot be interrupted.
inline const std::atomic<bool> kNeverInterrupted{false};

/// Throws InterruptedError if the flag is set. Must be called between two calls to FMUs, so that a step with many calls
/// can be interrupted.
inline void stop_if_interrupted(const std::atomic<bool>& interrupted) {
  if (interrupted.load(std::memory_order_relaxed)) throw InterruptedError();
}

/// A line of text without heap memory, for signal handlers and forked processes. Truncates long texts.
class SignalLine {
 public:
  SignalLine& operator<<(std::string_view text) {
    for (const char c : text) {
      if (size_ < bytes_.size()) bytes_[size_++] = c;
    }
    return *this;
  }
  SignalLine& operator<<(std::int64_t number) {
    std::array<char, 24> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr;
    return *this << std::string_view(digits.data(), static_cast<std::size_t>(end - digits.data()));
  }
  std::string_view text() const { return {bytes_.data(), size_}; }
  void write_to(int descriptor) const { static_cast<void>(!::write(descriptor, bytes_.data(), size_)); }

 private:
  std::array<char, 1024> bytes_;
  std::size_t size_ = 0;
};

}  // namespace mebots::master
