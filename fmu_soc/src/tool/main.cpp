// SPDX-License-Identifier: Apache-2.0
//
// mebots-soc run PROGRAM.elf [options]: runs a bare-metal program outside any FMU. Exit code: tohost >> 1 or what the
// firmware passed to EXIT (low 8 bits), 101 after a fault or at a limit, 102 for bad input.
#include "command_line/told_by_itself.hpp"
#include "tool/options.hpp"
#include "tool/run.hpp"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <csignal>
#include <string>

int main(int argc, char** argv) {
  using namespace mebots::soc::tool;
  std::signal(SIGXFSZ, SIG_IGN);  // a file at the limit of its size is an error that is told, as a full disk is
  CLI::App app{"Runs bare-metal RISC-V programs on the simulated chip"};
  app.set_version_flag("--version", "mebots-soc " MEBOTS_VERSION);
  app.require_subcommand(1);
  Options options;
  auto* command = app.add_subcommand("run", "Run a program until it stores to tohost, exits or faults");
  command->add_option("program", options.program, "ELF32 file for RV32IMC")->type_name("FILE.elf")->required();
  command
      ->add_option("--board", options.board,
                   "Board file, or the name of one of MEbots' own; without one: RAM around the program's segments")
      ->type_name("BOARD");
  command
      ->add_option("--devices", options.device_folders,
                   "Folder with the libraries of devices that the board names, when they do not lie beside it")
      ->type_name("FOLDER");
  command->add_option("--flash", options.flash, "What the board's flash holds at the start")->type_name("FILE");
  command
      ->add_option("--pictures", options.pictures,
                   "Folder of what the board's camera sees: .png and .pgm files, one a picture, in the order of their "
                   "names; the program ends when it waits for one more")
      ->type_name("FOLDER");
  command
      ->add_option("--signature", options.signature,
                   "Write the words from begin_signature to end_signature into this file")
      ->type_name("FILE");
  command->add_option("--trace", options.trace, "Write every instruction into this file, as Spike's --log-commits does")
      ->type_name("FILE");
  command->add_flag("--trace-cycles", options.trace_cycles, "Add the cycle as a comment to each line of the trace");
  command
      ->add_option("--profile", options.profile,
                   "Write time and energy per function and call stack: .json for speedscope, .callgrind or .out for "
                   "KCachegrind")
      ->type_name("FILE");
  command
      ->add_option("--power-trace", options.power_trace,
                   "Write power and states over time: .json for Perfetto, .vcd for GTKWave")
      ->type_name("FILE");
  command->add_flag("--interpret", options.interpret, "Do not translate hot code to host code; counts are the same");
  command
      ->add_option("--host-files", options.host_files,
                   "Folder below which the program may open files by semihosting or system calls")
      ->type_name("FOLDER");
  command->add_option("--gdb", options.gdb_port, "Wait for gdb on this port of 127.0.0.1; 0 takes a free one")
      ->check(CLI::Range(0, 65535));
  command->add_option("--max-instructions", options.max_instructions, "Stop after exactly this many")
      ->type_name("N")
      ->check(CLI::Validator(
          [](const std::string& text) {
            const bool good = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
            return good ? std::string() : fmt::format("'{}' is not a whole number from 0 on", text);
          },
          ""));
  command->footer(
      "Exit codes:\n"
      "  what the program stored to tohost, shifted right by one, or passed to EXIT (low 8 bits)\n"
      "  101 a fault, the limit, kill in gdb, a sleep that nothing ends, an endless loop of a program without limit\n"
      "  102 bad input: command line, files, program, board; nothing ran\n"
      "Examples:\n"
      "  mebots-soc run gate.elf --board ai_deck --max-instructions 3000000 --profile gate.json\n"
      "  mebots-soc run hello.elf --host-files .\n"
      "  mebots-soc run PULPDroNet_GAPuino --board gap8 --flash WeightsPULPDroNet.raw --pictures FOLDER");
  app.name("mebots-soc");
  if (const auto code = mebots::command_line::tell_of_it(app, MEBOTS_VERSION, argc, argv)) return *code;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    fmt::print(stderr, "mebots-soc: {}. `mebots-soc run --help` tells what it takes\n", error.what());
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
