// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mebots::soc::tool {

/// What the user asked `mebots-soc run` for.
struct Options {
  std::string program;
  std::optional<std::string> board;
  std::optional<std::string> core;
  std::vector<std::string> device_folders;
  std::optional<std::string> flash;
  std::optional<std::string> pictures;
  std::optional<std::string> signature;
  std::optional<std::string> trace;
  bool trace_cycles = false;
  std::optional<std::string> profile;
  std::optional<std::string> power_trace;
  bool interpret = false;
  std::optional<std::string> host_files;
  std::optional<int> gdb_port;
  std::optional<std::uint64_t> max_instructions;
};

/// Lets the command take them, with what its help says of each; they are set when the command line is parsed.
void add_options(CLI::App& command, Options& options);

/// Throws Error for contradictory options: an empty name, one file for two purposes, an input of the run as its output,
/// a path to a folder that does not exist.
void check(const Options& options);

inline constexpr int kFaultOrLimit = 101;
inline constexpr int kBadInput = 102;

/// Runs a program to its end and reports. Gives the exit code: tohost >> 1 or what the firmware passed to EXIT (low 8
/// bits), or kFaultOrLimit. Throws Error for bad input.
int run(const Options& options);

}  // namespace mebots::soc::tool
