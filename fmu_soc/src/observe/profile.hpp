// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/observer.hpp"
#include "observe/call_tree.hpp"
#include "observe/functions.hpp"
#include "observe/text_file.hpp"
#include "soc.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace mebots::soc::observe {

/// Time and energy of the chip by function and call stack of its fabric controller.
///
/// Stacks follow the calling convention: jal and jalr that write a link register (ra, t0) are calls; a jump through
/// one that meets a return address of the stack is a return to it; any other way into another function takes the place
/// of the function that it comes from (a tail call). A trap or interrupt is a frame of its own until its mret; so is
/// sleep.
class Profile final : public Observer {
 public:
  /// `option` names in errors who asked for the file. Its ending chooses the format: .json is speedscope's; .callgrind
  /// and .out are callgrind's. Throws Error for another ending and for a file that cannot be written.
  Profile(const std::string& option, const std::string& path, const Soc& soc);

  void retired(const Hart& hart, const Retired& instruction) override;
  void trapped(const Hart& hart, const Trapped& trap) override;
  void slept(const Hart& hart) override;
  void woke(const Hart& hart) override;

  /// The chip was put into an earlier state: what has been counted stays, stacks start anew.
  void restored();
  /// Counts up to now and writes the file. Throws Error when that fails.
  void finish();

  const CallTree& tree() const { return tree_; }
  const Functions& functions() const { return functions_; }
  /// What the tree has counted; equal to what the run has, to the last unit.
  Cost total() const { return tree_.inclusive()[CallTree::kRoot]; }

 private:
  enum class Kind : std::uint8_t { function, trap, sleep };
  struct Frame {
    std::uint32_t node = 0;
    std::uint32_t place = 0;
    std::uint32_t return_address = 0;
    Kind kind = Kind::function;
  };

  void charge(const Cost& now);
  Cost now() const;
  void push(std::uint32_t place, std::uint32_t return_address, Kind kind);
  void go_to(std::uint32_t address);
  bool return_to(std::uint32_t address);
  void return_from_trap(std::uint32_t address);

  const Soc& soc_;
  Functions functions_;
  CallTree tree_;
  std::vector<Frame> stack_;
  Cost charged_;
  std::uint32_t asleep_ = 0;
  bool callgrind_ = false;
  TextFile file_;
};

}  // namespace mebots::soc::observe
