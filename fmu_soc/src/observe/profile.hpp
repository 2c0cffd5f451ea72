// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clock/clock.hpp"
#include "observe/core_profile.hpp"
#include "observe/functions.hpp"
#include "observe/text_file.hpp"
#include "soc/soc.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

namespace mebots::soc::observe {

/// Stores the counts of a profile in consecutive windows of time. The sum over all windows is equal to the sum over the
/// call trees.
///
/// A window ends at a call of stepped() or restart(). If there are kMost windows, neighbours are joined in pairs, and
/// later windows are twice as long.
class ProfileWindows {
 public:
  static constexpr std::size_t kMost = 1024;

  struct Part {
    std::uint32_t hart = 0;
    std::uint32_t node = 0;  // number of the node in the hart's call tree
    Cost self;
  };
  struct Window {
    Picoseconds from = 0;
    Picoseconds to = 0;
    std::vector<Part> parts;  // sorted by hart, then by node
  };

  ProfileWindows(Picoseconds start, std::size_t harts) : from_(start), to_(start), counted_(harts) {}

  /// Extends the present window to `time`, and closes it if it is long enough. The call trees of the harts must already
  /// contain all costs up to `time`.
  void stepped(Picoseconds time, const std::deque<CoreProfile>& harts);
  /// Closes the present window, and starts a new one at `time`, which may be earlier. Must also be called at the end of
  /// the run.
  void restart(Picoseconds time, const std::deque<CoreProfile>& harts);

  const std::vector<Window>& windows() const { return windows_; }

 private:
  void close(const std::deque<CoreProfile>& harts);
  void join_neighbours();

  Picoseconds from_;
  Picoseconds to_;
  std::size_t steps_ = 0;                   // number of steps in the open window
  std::size_t steps_a_window_ = 1;          // number of steps in a closed window; a power of 2
  std::vector<std::vector<Cost>> counted_;  // costs in all closed windows, indexed by hart and node
  std::vector<Window> windows_;
};

/// Writes a profile file: time and energy for each hart, function and call stack, both for the whole run and for
/// windows of time.
class Profile {
 public:
  /// `option` is the command-line option for error messages. The extension of `path` selects the format: .json for
  /// speedscope, .callgrind and .out for callgrind. Throws Error if the extension is another one, or if the file cannot
  /// be written.
  Profile(const std::string& option, const std::string& path, const Soc& soc);

  /// Returns the observer to attach to the hart `number`.
  CoreProfile& hart(unsigned number) { return harts_[number]; }
  const Functions& functions() const { return functions_; }

  /// Restarts the call stacks after the chip was restored to an earlier state. The counts are kept.
  void restored();
  /// Must be called each time the caller has run the chip, for example after each communication step.
  void stepped();
  const ProfileWindows& windows() const { return windows_; }
  /// Adds all costs up to now and writes the file. Leaves out cluster cores that executed nothing. Throws Error if the
  /// file cannot be written.
  void finish();

 private:
  const Soc& soc_;
  Functions functions_;
  std::deque<CoreProfile> harts_;
  ProfileWindows windows_;
  bool callgrind_ = false;
  TextFile file_;
};

}  // namespace mebots::soc::observe
