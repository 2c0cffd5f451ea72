// SPDX-License-Identifier: Apache-2.0
//
// Implements mebots-soc run PROGRAM.elf [options], which runs a bare-metal program without FMI. Exit code: tohost >> 1,
// or the low 8 bits of the value in EXIT; 101 after a fault or at a limit; 102 for invalid input.
#include "command_line/command.hpp"
#include "tool/run.hpp"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <string_view>

int main(int argc, char** argv) {
  using namespace mebots::soc::tool;
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the size limit of a file fails with an error, as on a full disk
  CLI::App app{"Runs bare-metal RISC-V programs on the simulated chip"};
  app.set_version_flag("--version", "mebots-soc " MEBOTS_VERSION);
  app.require_subcommand(1);
  // Writes each line at once, so that no line is lost if the run is killed.
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
  Options options;
  auto* command = app.add_subcommand("run", "Run a program until it stores to tohost, exits or faults");
  add_options(*command, options);
  app.name("mebots-soc");
  if (const auto code = mebots::command_line::handle_hidden_options(app, MEBOTS_VERSION, argc, argv)) return *code;
  // CLI11 does not pass arguments after -- to a subcommand with complete positional options. Therefore these arguments
  // are removed first.
  auto** const last = argv + argc;
  auto** const mark = std::find_if(argv, last, [](const char* text) { return std::string_view(text) == "--"; });
  try {
    app.parse(static_cast<int>(mark - argv), argv);
    if (mark != last) options.arguments.insert(options.arguments.end(), mark + 1, last);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // the option was --help or --version
    fmt::print(stderr, "mebots-soc: {}. `mebots-soc run --help` lists its options\n", error.what());
    return kBadInput;
  }
  try {
    check(options);
    return run(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "mebots-soc: {}\n", error.what());
    return kBadInput;
  }
}
