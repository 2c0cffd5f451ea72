// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slave/environment_variables.hpp"

#include <sys/resource.h>
#include <sys/types.h>

#include <array>
#include <csignal>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master {

/// What an FMU in this process can change for everybody: mask of file modes, working directory, locale, environment
/// variables, limits, open descriptors, signal handlers. Whoever changes one of them changes what the other FMUs and
/// the master compute or write. One at a time may be looked at; not for use by two threads at once.
class ProcessState {
 public:
  /// Open descriptors, and the file that each leads to. Without connections of the network, which end without an FMU.
  using Files = std::map<int, std::pair<dev_t, ino_t>>;

  /// As it stands. Of the open descriptors those in `files` that still lead there; others may be closed by whoever
  /// opened them.
  explicit ProcessState(const Files& files = open_files());
  ~ProcessState();
  ProcessState(const ProcessState&) = delete;
  ProcessState& operator=(const ProcessState&) = delete;

  /// What is different now, one text each: "the mask of file modes became 000 (put back to 022)". Puts back what can
  /// be: not descriptors, save the standard three, and never signal handlers, which the FMU may need. What stays is
  /// told once in the life of the process.
  std::vector<std::string> put_right() const;

  static Files open_files();
  /// Those of input, output and errors.
  static Files standard_files();

 private:
  static constexpr int kStandard = 3;  // descriptors of input, output and errors
  static constexpr std::array kLimits = {RLIMIT_AS,    RLIMIT_CORE,   RLIMIT_CPU,  RLIMIT_DATA,
                                         RLIMIT_FSIZE, RLIMIT_NOFILE, RLIMIT_STACK};

  void compare_files(std::vector<std::string>& texts) const;
  void compare_limits(std::vector<std::string>& texts) const;
  void compare_handlers(std::vector<std::string>& texts) const;

  mode_t umask_;
  std::string folder_;
  std::string locale_;
  EnvironmentVariables environment_;
  std::array<rlimit, kLimits.size()> limits_{};
  Files files_;
  std::array<int, kStandard> copies_{};  // of the standard descriptors; -1 where there is none
  std::map<int, struct sigaction> handlers_;
};

}  // namespace mebots::master
