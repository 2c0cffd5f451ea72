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

/// Throws Error for what cannot be meant: an empty name, one file for two things, a file that the run reads as output,
/// a folder that is none.
void check(const Options& options);

}  // namespace mebots::soc::tool
