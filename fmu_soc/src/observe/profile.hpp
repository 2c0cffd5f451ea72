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

/// What a profile has counted, by spans of time that follow each other: the parts of all windows add up to the trees.
///
/// A window is a whole number of the caller's steps. When there are too many, neighbours are joined, and from then on
/// windows last twice as long; so a long run costs no more memory than a short one.
class ProfileWindows {
 public:
  static constexpr std::size_t kMost = 1024;

  struct Part {
    std::uint32_t hart = 0;
    std::uint32_t node = 0;  // of the hart's call tree
    Cost self;
  };
  struct Window {
    Picoseconds from = 0;
    Picoseconds to = 0;
    std::vector<Part> parts;  // in the order of harts and nodes
  };

  ProfileWindows(Picoseconds start, std::size_t harts) : from_(start), to_(start), counted_(harts) {}

  /// Ends a step at `time`; the harts have counted up to there.
  void stepped(Picoseconds time, const std::deque<CoreProfile>& harts);
  /// Restarts at `time`, which may be earlier. Also called at the end.
  void restart(Picoseconds time, const std::deque<CoreProfile>& harts);

  const std::vector<Window>& windows() const { return windows_; }

 private:
  void close(const std::deque<CoreProfile>& harts);
  void join_neighbours();

  Picoseconds from_;
  Picoseconds to_;
  std::size_t steps_ = 0;                   // in the open window
  std::size_t steps_a_window_ = 1;          // a power of 2
  std::vector<std::vector<Cost>> counted_;  // by hart and node, in windows that are closed
  std::vector<Window> windows_;
};

/// Time and energy of the chip by hart, function and call stack, of all of the run and by spans of time, as one file.
class Profile {
 public:
  /// `option` names in errors who asked for the file. Its ending chooses the format: .json is speedscope's; .callgrind
  /// and .out are callgrind's. Throws Error for another ending and for a file that cannot be written.
  Profile(const std::string& option, const std::string& path, const Soc& soc);

  /// Who watches a hart, numbered as in the chip.
  CoreProfile& hart(unsigned number) { return harts_[number]; }
  const Functions& functions() const { return functions_; }

  /// The chip was put into an earlier state: what has been counted stays, stacks start anew.
  void restored();
  /// The caller's span of time is over.
  void stepped();
  const ProfileWindows& windows() const { return windows_; }
  /// Counts up to now and writes the file, without those cores of the cluster that ran nothing. Throws Error when that
  /// fails.
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
