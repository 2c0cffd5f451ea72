// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <optional>
#include <string>

/// An FMU may fork helpers that exit or call exec(). If a forked copy returns from the FMU's call instead, it would
/// execute the rest of the run a second time. Such a copy is ended, and the original process gets a report.
namespace mebots::master {

/// During its lifetime, receives reports of forked copies that returned from calls to this process's FMUs.
class ForkedCopies {
 public:
  /// The maximum number of receivers at a time.
  static constexpr int kMost = 256;

  ForkedCopies();
  ~ForkedCopies();
  ForkedCopies(const ForkedCopies&) = delete;
  ForkedCopies& operator=(const ForkedCopies&) = delete;

  /// Returns the report of the first copy that returned, or empty. Waits briefly if copies still run. Call it once,
  /// after the last call to an FMU that may fork.
  std::optional<std::string> returned();

 private:
  void close_end(int& end);

  int read_end_ = -1;
  int write_end_ = -1;
  int slot_ = -1;
};

namespace detail {
/// The kernel sets it to 0 in a forked copy of the process. A copy that the embedding program forked, outside of a call
/// to an FMU, sets it again.
extern std::atomic<char>* original;
}  // namespace detail

/// Call it before the first call to an FMU. May be called from any thread.
void detect_forked_copies();

/// Returns true in a process that was forked in a call to an FMU.
inline bool is_forked_copy() noexcept {
  return detail::original->load(std::memory_order_relaxed) == 0;
}

/// Reports the copy and the call from which it returned to the original process and on standard error. Ends the copy.
[[noreturn]] void end_forked_copy() noexcept;

}  // namespace mebots::master
