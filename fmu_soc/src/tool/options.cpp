// SPDX-License-Identifier: Apache-2.0
#include "tool/run.hpp"

#include "board/board_file.hpp"
#include "mebots/error.hpp"

#include <fmt/core.h>

#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

namespace mebots::soc::tool {
namespace {

struct NamedFile {
  std::string_view option;
  std::string path;
};

constexpr auto kFooter =
    "Exit codes:\n"
    "  what the program stored to tohost, shifted right by one, or passed to EXIT (low 8 bits)\n"
    "  101 a fault, a limit, kill in gdb, a sleep that nothing ends, an endless loop of a program without limit\n"
    "  102 bad input: command line, files, program, board; nothing ran. Also: --save-state found nothing to save\n"
    "Examples:\n"
    "  mebots-soc run gate.elf --board ai_deck --max-instructions 3000000 --profile gate.json\n"
    "  mebots-soc run hello.elf --host-files .\n"
    "  mebots-soc run zephyr.elf --board virt --console stdio --max-time 10s\n"
    "  mebots-soc run --user coremark.elf 0 0 0x66 2000\n"
    "  mebots-soc run PULPDroNet_GAPuino --board gap8 --flash WeightsPULPDroNet.raw --pictures FOLDER";

bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  if (std::filesystem::is_character_file(a, ignored)) return false;  // several outputs may be written to /dev/stdout
  return std::filesystem::equivalent(a, b, ignored) || std::filesystem::path(a).lexically_normal() == b;
}

}  // namespace

void add_options(CLI::App& command, Options& options) {
  command.add_option("program", options.program, "ELF32 file for RV32IMC")->type_name("FILE.elf")->required();
  command
      .add_option("arguments", options.arguments,
                  "Arguments of the program, with --user; after -- they may begin with a dash")
      ->type_name("ARGUMENT");
  command
      .add_option("--board", options.board,
                  "Board file, or name of a shipped board; default: only RAM around the program's segments")
      ->type_name("BOARD");
  command
      .add_option("--core", options.core,
                  "Core of a run without --board: cv32e40p (default), ri5cy, or rv32imc, whose mtvec and counters "
                  "follow the privileged specification alone")
      ->type_name("CORE");
  command
      .add_option("--ram", options.ram,
                  "RAM of BASE:SIZE bytes, such as 0x80000000:64M, instead of RAM around the program's segments, or "
                  "more RAM for the board; more than once for several")
      ->type_name("BASE:SIZE");
  command.add_flag(
      "--user", options.user,
      "Execute ecall as a system call of Linux (console, files, heap, time, exit), for programs built with newlib");
  command
      .add_option("--console", options.console,
                  "Input of the console: stdio, the standard input; pty, a new pseudo terminal for input and output")
      ->type_name("stdio|pty");
  command
      .add_option("--devices", options.device_folders,
                  "Folder with the libraries of devices that the board names; default: the folder of the board")
      ->type_name("FOLDER");
  command.add_option("--flash", options.flash, "Initial content of the board's flash")->type_name("FILE");
  command
      .add_option("--pictures", options.pictures,
                  "Folder of the pictures that the board's camera takes: .png and .pgm files in the order of their "
                  "names. The program ends when it waits for a picture after the last one")
      ->type_name("FOLDER");
  command
      .add_option("--signature", options.signature,
                  "Write the words from begin_signature to end_signature into this file")
      ->type_name("FILE");
  command.add_option("--trace", options.trace, "Write every instruction into this file, as Spike's --log-commits does")
      ->type_name("FILE");
  command.add_flag("--trace-cycles", options.trace_cycles, "Add the cycle as a comment to each line of the trace");
  command
      .add_option("--profile", options.profile,
                  "Write time and energy per function and call stack: .json for speedscope, .callgrind or .out for "
                  "KCachegrind")
      ->type_name("FILE");
  command
      .add_option("--power-trace", options.power_trace,
                  "Write power and states over time: .json for Perfetto, .vcd for GTKWave")
      ->type_name("FILE");
  command.add_option("--json", options.json, "Write the report as JSON, in SI units, into this file")
      ->type_name("FILE");
  command
      .add_option(
          "--report", options.report,
          "Write the report as JSON into this file, with the cycles of each core and function by cause, and with "
          "the use of caches and banks; the run is slower")
      ->type_name("FILE.json");
  command
      .add_option("--coverage", options.coverage,
                  "Write how often source lines, functions and branches ran into this file, for lcov and genhtml")
      ->type_name("FILE");
  command
      .add_option("--pipeline", options.pipeline,
                  "Write each instruction as stages of the pipeline into this file, for Konata")
      ->type_name("FILE");
  command
      .add_option("--pipeline-hart", options.pipeline_hart,
                  "Hart of --pipeline: 0, the fabric controller; from 1 on, cores of the cluster")
      ->type_name("N");
  command
      .add_option("--page", options.page,
                  "Write a page for a browser into this file: energy by part, counts, functions, power over time")
      ->type_name("FILE.html");
  command.add_flag("--interpret", options.interpret, "Do not translate hot code to host code; counts are the same");
  command
      .add_option("--host-files", options.host_files,
                  "Folder below which the program may open files by semihosting or system calls")
      ->type_name("FOLDER");
  command.add_option("--gdb", options.gdb_port, "Wait for gdb on this port of 127.0.0.1; 0: any free port")
      ->check(CLI::Range(0, 65535));
  command
      .add_option("--load-state", options.load_state,
                  "Begin with the state in this file, which --save-state wrote with the same program, board and inputs")
      ->type_name("FILE");
  command
      .add_option("--save-state", options.save_state,
                  "Write the chip's state at the end of the run into this file, for example at --max-time")
      ->type_name("FILE");
  command.add_flag("--control", options.control,
                   "Take commands from standard input, one JSON object per line, for tests in Python");
  command.add_option("--max-instructions", options.max_instructions, "Stop after exactly this number of instructions")
      ->type_name("N")
      ->check(CLI::Validator(
          [](const std::string& text) {
            const bool good = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
            return good ? std::string() : fmt::format("'{}' is not a whole number from 0 on", text);
          },
          ""));
  command.add_option("--max-time", options.max_time, "Stop at this simulated time, such as 2s or 500us")
      ->type_name("TIME");
  command.add_option("--timeout", options.timeout, "Stop after this wall time, such as 10s")->type_name("TIME");
  command.footer(kFooter);
}

void check(const Options& options) {
  std::vector<NamedFile> inputs{{"the program", options.program}};
  if (options.board) inputs.push_back({"--board", *options.board});
  if (options.flash) inputs.push_back({"--flash", *options.flash});
  if (options.load_state) inputs.push_back({"--load-state", *options.load_state});
  std::vector<NamedFile> outputs;
  const auto add = [&](std::string_view option, const std::optional<std::string>& path) {
    if (path) outputs.push_back({option, *path});
  };
  add("--signature", options.signature);
  add("--trace", options.trace);
  add("--profile", options.profile);
  add("--power-trace", options.power_trace);
  add("--json", options.json);
  add("--report", options.report);
  add("--coverage", options.coverage);
  add("--pipeline", options.pipeline);
  add("--page", options.page);
  add("--save-state", options.save_state);
  for (const auto* list : {&inputs, &outputs}) {
    for (const auto& file : *list) {
      if (file.path.empty()) throw Error(fmt::format("{} has an empty file name; give a path", file.option));
    }
  }
  if (options.console && options.console != "stdio" && options.console != "pty") {
    throw Error(fmt::format("--console {}: there are stdio and pty", *options.console));
  }
  if (!options.arguments.empty() && !options.user) {
    throw Error(fmt::format("\"{}\" is an argument of the program, which only --user passes on", options.arguments[0]));
  }
  if (options.core && options.board) {
    throw Error(fmt::format("--core {}: the board names its core; leave --core out", *options.core));
  }
  if (options.core) {
    try {
      BoardDescription unused;
      set_core(unused, *options.core);
    } catch (const Error& error) {
      throw Error(fmt::format("--core {}: {}", *options.core, error.what()));
    }
  }
  for (const auto& folder : options.device_folders) {
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored)) {
      throw Error(fmt::format("--devices {}: this is not a folder", folder));
    }
  }
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (const auto& input : inputs) {
      if (same_file(outputs[i].path, input.path)) {
        throw Error(fmt::format("{} {} is also {}; name another file to write", outputs[i].option, outputs[i].path,
                                input.option));
      }
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (same_file(outputs[i].path, outputs[k].path)) {
        throw Error(fmt::format("{} and {} both name {}; give each a different file", outputs[k].option,
                                outputs[i].option, outputs[i].path));
      }
    }
  }
  if (options.page && options.profile && std::filesystem::path(*options.profile).extension() != ".json") {
    throw Error(
        fmt::format("--page shows a profile in speedscope's format; --profile {} must end with .json, or be left out",
                    *options.profile));
  }
  if (options.control && (options.console || options.gdb_port || options.max_instructions || options.max_time ||
                          options.timeout || options.page || options.signature)) {
    throw Error(
        "--control takes the console and decides how far the run goes: leave --console, --gdb, --page, --signature, "
        "--max-time, --max-instructions and --timeout out");
  }
  if ((options.load_state || options.save_state) && (options.user || options.host_files || options.control)) {
    throw Error(
        "a saved state contains the chip, but not the files and inputs that the host provides: use --load-state and "
        "--save-state without --user, --host-files and --control");
  }
  if (options.load_state && (options.page || options.report)) {
    throw Error("--page and --report describe a run from its start: leave them out, or --load-state");
  }
  if (options.pipeline_hart != 0 && !options.pipeline) {
    throw Error("--pipeline-hart needs --pipeline FILE: it chooses the hart of that file");
  }
  if (options.trace_cycles && !options.trace) {
    throw Error("--trace-cycles needs --trace FILE: it adds a column to that file");
  }
}

}  // namespace mebots::soc::tool
