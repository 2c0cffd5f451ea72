// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <optional>
#include <string>

/// Ends forked copies of this process that return from a call to an FMU. An FMU may fork children that exit or call
/// exec(). A child that returns would run the rest of the simulation a second time. Such a child sends a report to the
/// original process and ends.
namespace mebots::master {

/// Receives a report from each forked copy of this process that returns from a call to an FMU.
class ForkedCopies {
 public:
  /// The maximum number of objects at the same time.
  static constexpr int kMost = 256;

  ForkedCopies();
  ~ForkedCopies();
  ForkedCopies(const ForkedCopies&) = delete;
  ForkedCopies& operator=(const ForkedCopies&) = delete;

  /// Returns the report of the first forked copy that returned from a call to an FMU; nullopt if no copy returned.
  /// Waits for a short time if forked copies are still running. Must be called once, after the last call to an FMU.
  std::optional<std::string> returned();

 private:
  void close_end(int& end);

  int read_end_ = -1;
  int write_end_ = -1;
  int slot_ = -1;
};

namespace detail {
/// A flag that the kernel sets to 0 in a forked copy. If the embedding program forks outside of calls to FMUs, the
/// child sets the flag again.
extern std::atomic<char>* original;
}  // namespace detail

/// Must be called before the first call to an FMU, from any thread.
void detect_forked_copies();

/// True if this process was forked during a call to an FMU.
inline bool is_forked_copy() noexcept {
  return detail::original->load(std::memory_order_relaxed) == 0;
}

/// Ends this forked copy. Before that, reports its return from a call to the original process and on standard error.
[[noreturn]] void end_forked_copy() noexcept;

}  // namespace mebots::master
