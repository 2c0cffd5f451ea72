// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <optional>
#include <string>

/// Ends forked copies of the process that return from a call to an FMU. An FMU may fork helpers that exit or call
/// exec(). However, a copy that returns would execute the rest of the run a second time. Therefore mebots ends such a
/// copy, after the copy has sent a report to the original process.
namespace mebots::master {

/// Receives reports while it exists: one for each forked copy of this process that returns from the call to its FMU.
class ForkedCopies {
 public:
  /// The maximum number of receivers that can exist at the same time.
  static constexpr int kMost = 256;

  ForkedCopies();
  ~ForkedCopies();
  ForkedCopies(const ForkedCopies&) = delete;
  ForkedCopies& operator=(const ForkedCopies&) = delete;

  /// Returns the report of the first copy that returned from a call, or nullopt if no copy returned. Waits briefly if
  /// copies are still running. Must be called once, after the last call to an FMU that may fork.
  std::optional<std::string> returned();

 private:
  void close_end(int& end);

  int read_end_ = -1;
  int write_end_ = -1;
  int slot_ = -1;
};

namespace detail {
/// Points to a flag that the kernel sets to 0 in a forked copy of the process. If the embedding program creates the
/// copy outside of calls to FMUs, the copy sets the flag again.
extern std::atomic<char>* original;
}  // namespace detail

/// Must be called before the first call to an FMU. May be called from any thread.
void detect_forked_copies();

/// Returns true if this process was forked during a call to an FMU.
inline bool is_forked_copy() noexcept {
  return detail::original->load(std::memory_order_relaxed) == 0;
}

/// Reports to the original process, and on standard error, that this forked copy returned from a call to an FMU. Then
/// ends the copy.
[[noreturn]] void end_forked_copy() noexcept;

}  // namespace mebots::master
