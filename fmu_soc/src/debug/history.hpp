// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "soc/soc.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace mebots::soc::debug {

/// Stores states of a debugged run. A replay from one of these states can reach any earlier instruction.
///
/// A position is the number of instructions that all harts have begun since the start. A replay begins the instructions
/// in the same order, because the run is divided into the same pieces. A replay prints no output, and takes its input
/// from a log.
class History {
 public:
  struct Snapshot {
    std::uint64_t position = 0;
    std::uint64_t calls = 0;  // number of calls of input() before this state
    std::size_t inputs = 0;   // number of log entries that were read before this state
    std::vector<std::byte> state;
  };

  /// @param most_bytes  limit of the total size of all states; the first and the newest state are always kept
  explicit History(std::size_t most_bytes = kMostBytes) : most_bytes_(most_bytes) {}

  /// Saves the state of the chip, so that a replay can start from it. Must be called before each piece of the run. Does
  /// nothing during a replay. If there are more than kMost states, or if they exceed `most_bytes`, deletes every second
  /// state. From then on, only half as many calls save a state.
  void record(const Soc& soc);
  void restore(Soc& soc, std::size_t snapshot);
  /// Restores the start of the program, and discards all later states. has_start() must be true.
  void restart(Soc& soc);
  /// Returns false if the start of the program was not recorded, or was discarded by clear().
  bool has_start() const { return !start_.state.empty(); }
  /// Discards all states except the start. Must be called after a change by gdb, which a replay would not repeat.
  void cut();
  /// Discards all states including the start. Must be called after the co-simulation has restored a state.
  void clear();

  /// Counts an instruction, and returns its position.
  std::uint64_t advance() {
    ++position_;
    frontier_ = std::max(frontier_, position_);
    return position_;
  }
  /// Marks all instructions before `position` as executed.
  void reach(std::uint64_t position) { frontier_ = std::max(frontier_, position); }
  std::uint64_t position() const { return position_; }
  const std::vector<Snapshot>& snapshots() const { return snapshots_; }

  /// Returns true during a replay, and while the program is being stopped for a replay.
  bool repeats() const { return leaves_ || position_ < frontier_; }
  /// Sets whether the run must end so that a saved state can be restored.
  void set_leaves(bool leaves) { leaves_ = leaves; }
  bool leaves() const { return leaves_; }
  /// Returns the next byte of input, or kNothingYet or kEnded (ConsolePort). In a replay, returns the same result as in
  /// the first run. Otherwise returns the result of `read`. If gdb has changed the chip, the bytes that were read
  /// before the change are returned again before `read` is called.
  int input(const std::function<int()>& read);

 private:
  static constexpr std::size_t kMost = 128;
  static constexpr std::size_t kMostBytes = std::size_t{512} << 20;

  std::size_t bytes() const;
  void thin();

  std::size_t most_bytes_;
  std::vector<Snapshot> snapshots_;  // sorted by position
  Snapshot start_;
  struct Input {
    std::uint64_t call = 0;  // number of the call of input() that read the byte
    int result = 0;          // byte, or ConsolePort::kEnded
  };
  std::vector<Input> log_;  // sorted by call; a call without an entry returned no byte
  std::size_t inputs_ = 0;
  std::uint64_t calls_ = 0;
  std::uint64_t latest_call_ = 0;  // calls with higher numbers are not part of a replay
  std::uint64_t position_ = 0;
  std::uint64_t frontier_ = 0;  // latest position that the program has reached
  std::uint64_t pieces_ = 0;    // pieces of the run since the last saved state
  std::uint64_t gap_ = 1;       // number of pieces from one saved state to the next
  bool leaves_ = false;
};

}  // namespace mebots::soc::debug
