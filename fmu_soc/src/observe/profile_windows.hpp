// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clock/clock.hpp"
#include "observe/core_profile.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
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

  /// One more step is over at `time`; the harts have counted up to there.
  void stepped(Picoseconds time, const std::deque<CoreProfile>& harts);
  /// Time goes on at `time`, which may be earlier. Or, at the end of all, nowhere.
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

}  // namespace mebots::soc::observe
