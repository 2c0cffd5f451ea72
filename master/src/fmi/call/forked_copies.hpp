// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <optional>
#include <string>

/// An FMU may fork helpers that exit or call exec(). If a forked copy of the process returns from the FMU's call, it
/// would execute the rest of the run a second time. Therefore mebots ends such a copy, which first sends a report to
/// the original process.
namespace mebots::master {

/// While this object exists, it receives a report if an FMU of this process has forked, and the forked copy returns
/// from the call to the FMU.
class ForkedCopies {
 public:
  /// The maximum number of receivers at a time.
  static constexpr int kMost = 256;

  ForkedCopies();
  ~ForkedCopies();
  ForkedCopies(const ForkedCopies&) = delete;
  ForkedCopies& operator=(const ForkedCopies&) = delete;

  /// Returns the report of the first copy that returned; empty if none did. Waits briefly if copies still run. Must be
  /// called once, after the last call to an FMU that may fork.
  std::optional<std::string> returned();

 private:
  void close_end(int& end);

  int read_end_ = -1;
  int write_end_ = -1;
  int slot_ = -1;
};

namespace detail {
/// A flag that the kernel sets to 0 in a forked copy of the process. If the embedding program forked the copy outside
/// of a call to an FMU, the copy sets the flag again.
extern std::atomic<char>* original;
}  // namespace detail

/// Must be called before the first call to an FMU. May be called from any thread.
void detect_forked_copies();

/// Returns true in a process that was forked in a call to an FMU.
inline bool is_forked_copy() noexcept {
  return detail::original->load(std::memory_order_relaxed) == 0;
}

/// Reports that this forked copy returned from a call to an FMU, to the original process and on standard error. Ends
/// the copy.
[[noreturn]] void end_forked_copy() noexcept;

}  // namespace mebots::master
