// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "observe/core_profile.hpp"
#include "observe/functions.hpp"
#include "observe/profile_windows.hpp"
#include "observe/text_file.hpp"
#include "soc/soc.hpp"

#include <deque>
#include <string>

namespace mebots::soc::observe {

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
