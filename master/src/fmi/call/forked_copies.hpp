// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <optional>
#include <string>

/// An FMU may fork helpers, which end or replace themselves. A forked copy that returns from the FMU's call would do
/// the rest of the run a second time. It is ended there, and the original process learns of it.
namespace mebots::master {

/// Receives the reports of copies that this process's FMUs forked and that came back, as long as this lives.
class ForkedCopies {
 public:
  /// At most this many receive reports at a time.
  static constexpr int kMost = 256;

  ForkedCopies();
  ~ForkedCopies();
  ForkedCopies(const ForkedCopies&) = delete;
  ForkedCopies& operator=(const ForkedCopies&) = delete;

  /// Returns the report of the first copy that came back; nothing if none did. If copies still run, waits for a moment.
  /// To be called once, after the last call to an FMU that may fork.
  std::optional<std::string> returned();

 private:
  void close_end(int& end);

  int read_end_ = -1;
  int write_end_ = -1;
  int slot_ = -1;
};

namespace detail {
/// The kernel sets it to 0 in a forked copy of the process. A copy that was not forked in a call to an FMU, so by the
/// program around, sets it again.
extern std::atomic<char>* original;
}  // namespace detail

/// Before the first call to an FMU. From any thread.
void detect_forked_copies();

/// Returns true in a process that was forked in a call to an FMU.
inline bool is_forked_copy() noexcept {
  return detail::original->load(std::memory_order_relaxed) == 0;
}

/// Reports the copy, with the call that it came back from, to the original process and on standard error. Ends it.
[[noreturn]] void end_forked_copy() noexcept;

}  // namespace mebots::master
