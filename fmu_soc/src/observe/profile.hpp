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

/// The counts of a profile by consecutive windows of time. The sum over all windows is equal to the sum over the call
/// trees.
///
/// A window is a whole number of the caller's steps. If there are too many windows, pairs of neighbours are joined, and
/// later windows are twice as long. Therefore the memory does not grow with the length of the run.
class ProfileWindows {
 public:
  static constexpr std::size_t kMost = 1024;

  struct Part {
    std::uint32_t hart = 0;
    std::uint32_t node = 0;  // in the hart's call tree
    Cost self;
  };
  struct Window {
    Picoseconds from = 0;
    Picoseconds to = 0;
    std::vector<Part> parts;  // ordered by hart and node
  };

  ProfileWindows(Picoseconds start, std::size_t harts) : from_(start), to_(start), counted_(harts) {}

  /// Ends a step at `time`. The harts have counted up to that time.
  void stepped(Picoseconds time, const std::deque<CoreProfile>& harts);
  /// Starts a new window at `time`, which may be earlier than the present window. Also called at the end of the run.
  void restart(Picoseconds time, const std::deque<CoreProfile>& harts);

  const std::vector<Window>& windows() const { return windows_; }

 private:
  void close(const std::deque<CoreProfile>& harts);
  void join_neighbours();

  Picoseconds from_;
  Picoseconds to_;
  std::size_t steps_ = 0;                   // in the open window
  std::size_t steps_a_window_ = 1;          // a power of 2
  std::vector<std::vector<Cost>> counted_;  // by hart and node, in closed windows
  std::vector<Window> windows_;
};

/// Writes a profile file: time and energy of the chip by hart, function and call stack, for the whole run and by
/// windows of time.
class Profile {
 public:
  /// `option` is the name of the option for messages. The extension determines the format: .json is speedscope's;
  /// .callgrind and .out are callgrind's. Throws Error for another extension, and if the file cannot be written.
  Profile(const std::string& option, const std::string& path, const Soc& soc);

  /// Returns the observer of a hart. `number` is the hart's number in the chip.
  CoreProfile& hart(unsigned number) { return harts_[number]; }
  const Functions& functions() const { return functions_; }

  /// Called after the chip was restored to an earlier state. The counts are kept, and the call stacks start again.
  void restored();
  /// Ends a step of the caller.
  void stepped();
  const ProfileWindows& windows() const { return windows_; }
  /// Counts up to now and writes the file, without cluster cores that executed nothing. Throws Error if that fails.
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
