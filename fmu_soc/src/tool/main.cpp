// SPDX-License-Identifier: Apache-2.0
//
// mebots-soc run PROGRAM.elf [--board FILE] [--signature FILE] [--max-instructions N]
//
// Runs a bare-metal program outside any FMU. Exit code: tohost >> 1 or what the firmware passed to EXIT (low 8
// bits), 101 after a fault or at a limit, 102 for bad input.
#include "soc.hpp"

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <limits>

namespace {

using namespace mebots::soc;

constexpr int kFaultOrLimit = 101;
constexpr int kBadInput = 102;
constexpr std::uint32_t kPage = 4096;
constexpr std::uint32_t kMiB = 1U << 20;

/// RAM from the page of the lowest segment, at least 4 MiB and at least 1 MiB past the highest segment.
BoardDescription board_around(const Elf& program) {
  std::uint64_t lowest = std::numeric_limits<std::uint32_t>::max();
  std::uint64_t highest = 0;
  for (const auto& segment : program.segments()) {
    lowest = std::min<std::uint64_t>(lowest, segment.address);
    highest = std::max<std::uint64_t>(highest, std::uint64_t{segment.address} + segment.size);
  }
  const auto base = lowest / kPage * kPage;
  auto end = std::max(base + std::uint64_t{4} * kMiB, (highest + kMiB + kPage - 1) / kPage * kPage);
  end = std::min<std::uint64_t>(end, std::uint64_t{1} << 32);
  if (end - base > 2048ULL * kMiB) {
    throw mebots::Error(fmt::format("{}: its segments span {} MiB, more than 2048: name a board", program.origin(),
                                    (end - base) / kMiB));
  }
  BoardDescription board;
  board.name = "none";
  board.memories.push_back({"ram", static_cast<std::uint32_t>(base), static_cast<std::uint32_t>(end - base)});
  return board;
}

struct Options {
  std::string program;
  std::string board;
  std::string signature;
  bool interpret = false;
  std::uint64_t max_instructions = std::numeric_limits<std::uint64_t>::max() / 2;
};

/// Runs in pieces, because every instruction takes a cycle or more: N instructions are left = N cycles are safe.
void run_instructions(Soc& soc, std::uint64_t limit) {
  while (soc.running() && soc.hart().counters().instructions < limit) {
    const auto& counters = soc.hart().counters();
    const auto before = counters.cycles;
    soc.run_cycles(counters.cycles + (limit - counters.instructions));
    if (counters.cycles == before) return;  // asleep for good
  }
}

void report(const Soc& soc, double host_s) {
  const auto& counters = soc.hart().counters();
  const auto energy = soc.energy();
  fmt::print("instructions {}\n", counters.instructions);
  fmt::print("cycles {}\n", counters.cycles);
  fmt::print("time {:.9g} s, of it asleep {:.9g} s\n", static_cast<double>(soc.now()) * 1e-12,
             static_cast<double>(soc.sleep_time()) * 1e-12);
  fmt::print("energy {:.9g} J: core_active {:.9g} J, memory {:.9g} J, leakage {:.9g} J\n", energy.total_j(),
             energy.core_active_j, energy.memory_j, energy.leakage_j);
  fmt::print("host {:.1f} MIPS\n", static_cast<double>(counters.instructions) / host_s / 1e6);
}

/// The words between the symbols begin_signature and end_signature, 8 hexadecimal digits a line.
void write_signature(const Soc& soc, const std::string& path) {
  const auto begin = soc.program().symbol("begin_signature");
  const auto end = soc.program().symbol("end_signature");
  if (!begin || !end || *end < *begin) {
    throw mebots::Error(fmt::format("--signature {}: {} has no symbols begin_signature and end_signature in this order",
                                    path, soc.program().origin()));
  }
  std::ofstream file(path);
  for (auto address = *begin; address < *end; address += 4) {
    std::uint32_t word = 0;
    if (!soc.memory().read(address, {reinterpret_cast<std::uint8_t*>(&word), sizeof word})) {
      throw mebots::Error(fmt::format("--signature {}: no memory at 0x{:08x}", path, address));
    }
    file << fmt::format("{:08x}\n", word);
  }
  file.close();
  if (!file) throw mebots::Error(fmt::format("--signature {}: cannot be written", path));
}

int run(const Options& options) {
  const auto program = Elf::read(options.program);
  auto chip = gap8();
  BoardDescription board;
  if (options.board.empty()) {
    board = board_around(program);
    chip.timing.kind = CoreKind::cv32e40p;
    chip.memory_leakage_w_per_byte = 0;  // this RAM is nobody's chip
  } else {
    board = read_board(options.board);
  }
  Settings settings;
  settings.mission = {0.2777778, 1.0, 0.1, 0.5, 0.1, 0};
  settings.translate = !options.interpret;
  Listeners listeners;
  listeners.console = [](std::string_view line) { fmt::print("{}\n", line); };
  Soc soc(board, chip, settings, program, listeners);
  if (auto* battery = soc.battery()) {
    battery->set_voltage_v(3.7);
    battery->set_state_of_charge(1);
  }
  const auto tohost = program.symbol("tohost");
  if (tohost) soc.stop_when_stored(*tohost);

  const auto start = std::chrono::steady_clock::now();
  run_instructions(soc, options.max_instructions);
  report(soc, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  if (!options.signature.empty()) write_signature(soc, options.signature);
  switch (soc.end()) {
    case End::host: {
      std::uint32_t value = 0;
      soc.memory().read(*tohost, {reinterpret_cast<std::uint8_t*>(&value), sizeof value});
      fmt::print("tohost {}\n", value);
      return static_cast<int>(value >> 1 & 0xffU);
    }
    case End::exited:
      fmt::print("exit {}\n", soc.exit_code());
      return soc.exit_code() & 0xff;
    case End::faulted:
      fmt::print(stderr, "mebots-soc: {}\n", soc.fault_text());
      return kFaultOrLimit;
    default:
      break;
  }
  if (soc.hart().sleeping()) {
    fmt::print(stderr, "mebots-soc: the core sleeps at pc 0x{:08x} and nothing is left that could wake it\n",
               soc.hart().pc());
  } else {
    fmt::print(stderr, "mebots-soc: limit of {} instructions reached at pc 0x{:08x} in {}\n", options.max_instructions,
               soc.hart().pc(), program.where(soc.hart().pc()));
  }
  return kFaultOrLimit;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Runs bare-metal RISC-V programs on the simulated chip"};
  app.require_subcommand(1);
  Options options;
  auto* command = app.add_subcommand("run", "Run a program until it stores to tohost, exits or faults");
  command->add_option("program", options.program, "ELF32 file for RV32IMC")->required();
  command->add_option("--board", options.board, "Board description; without one: RAM around the program's segments");
  command->add_option("--signature", options.signature, "Write the program's signature into this file");
  command->add_flag("--interpret", options.interpret, "Do not translate hot code to host code; counts are the same");
  command->add_option("--max-instructions", options.max_instructions, "Stop after this many");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kBadInput;
  }
  try {
    return run(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "mebots-soc: {}\n", error.what());
    return kBadInput;
  }
}
