// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"

#include <atomic>
#include <string>

namespace mebots::master {

/// Somebody asked for the end of the run. Ends it at the last communication point that all instances reached.
class InterruptedError : public Error {
 public:
  /// `what_else`: what the interrupt cost, such as the process of an instance that did not come back.
  explicit InterruptedError(const std::string& what_else = "") : Error(ErrorCode::interrupted, what_else) {}
};

/// What stays false, for who is never interrupted.
inline const std::atomic<bool> kNeverInterrupted{false};

/// Throws InterruptedError once the flag is set. Between any two calls to FMUs, so that what is left of a step that
/// calls many of them is not waited for.
inline void stop_if_interrupted(const std::atomic<bool>& interrupted) {
  if (interrupted.load(std::memory_order_relaxed)) throw InterruptedError();
}

}  // namespace mebots::master
