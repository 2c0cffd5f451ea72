// SPDX-License-Identifier: Apache-2.0
// mebots-silicon-phases measures each phase of phases.c on a chip with the given energies. Prints JSON for power.py.
// For each phase, it contains seconds, the cluster's cycles and instructions, and the joules of each part of the chip.

#include "mebots/error.hpp"
#include "soc/soc.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

using namespace mebots::soc;

/// The state of the chip when the program prints a line.
struct Mark {
  std::string line;
  Picoseconds time = 0;
  EnergyLedger energy;
  double cycles = 0;
  double instructions = 0;
};

Mark mark(const Soc& chip, std::string_view line) {
  const auto counters = chip.cluster()->counters();
  return {std::string(line), chip.core_time(), chip.power().energy_at_core(), static_cast<double>(counters.cycles),
          static_cast<double>(counters.instructions)};
}

void print(const std::vector<Mark>& marks) {
  const char* before = "";
  fmt::print("{{\n");
  for (std::size_t i = 0; i + 1 < marks.size(); ++i) {
    const auto& begin = marks[i];
    const auto& end = marks[i + 1];
    if (begin.line.starts_with("checksum ")) {
      const auto name_end = begin.line.rfind(' ');
      fmt::print("{} \"{}\": \"{}\"", before, begin.line.substr(0, name_end), begin.line.substr(name_end + 1));
      before = ",\n";
    }
    if (!begin.line.starts_with("begin ")) continue;
    fmt::print("{} \"{}\": {{\"seconds\": {:.12g}, \"cycles\": {}, \"instructions\": {}", before, begin.line.substr(6),
               static_cast<double>(end.time - begin.time) * 1e-12, end.cycles - begin.cycles,
               end.instructions - begin.instructions);
    for (std::size_t part = 0; part < kParts; ++part) {
      fmt::print(", \"{}\": {:.9g}", kPartNames[part], end.energy.by_part_j[part] - begin.energy.by_part_j[part]);
    }
    fmt::print("}}");
    before = ",\n";
  }
  fmt::print("\n}}\n");
}

void run(const std::string& board_path, const std::string& energy, const Settings& settings, const Elf& program) {
  auto board = read_board(board_path);
  board.energy = energy;
  auto chip_data = chip_of(board);
  // Raises the cluster's highest clock at the lowest voltage, because published values are for 100 MHz at 1.0 V. The
  // chip's table does not allow this clock.
  chip_data.cluster_clock_at_lowest_voltage_hz =
      std::max(chip_data.cluster_clock_at_lowest_voltage_hz, settings.cluster_clock_hz);
  std::vector<Mark> marks;
  const Soc* running = nullptr;
  Listeners listeners;
  listeners.console = [&](std::string_view line) { marks.push_back(mark(*running, line)); };
  listeners.faults = [](std::string_view text) { fmt::print(stderr, "{}\n", text); };
  Soc chip(board, chip_data, settings, program, listeners);
  running = &chip;
  chip.run_cycles(std::uint64_t{1} << 40U);
  if (chip.end() != End::exited || chip.exit_code() != 0) {
    throw mebots::Error(fmt::format("the program did not end well: {}", chip.fault_text()));
  }
  marks.push_back(mark(chip, ""));
  print(marks);
}

}  // namespace

int main(int argc, char** argv) {
  std::string board;
  std::string energy = "gap8";
  std::string firmware;
  Settings settings;
  settings.cluster_clock_hz = 175e6;
  settings.clock_hz = 250e6;
  CLI::App app("Time and energy of the phases of silicon_phases.elf");
  app.add_option("--board", board, "Board description")->required()->check(CLI::ExistingFile);
  app.add_option("--energy", energy, "gap8 or gap8_silicon")->check(CLI::IsMember({"gap8", "gap8_silicon"}));
  app.add_option("--voltage", settings.voltage_v, "Core voltage [V]");
  app.add_option("--clock", settings.clock_hz, "Clock of the fabric controller [Hz]");
  app.add_option("--cluster-clock", settings.cluster_clock_hz, "Clock of the cluster [Hz]");
  app.add_option("firmware", firmware, "silicon_phases.elf")->required()->check(CLI::ExistingFile);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  }
  try {
    run(board, energy, settings, Elf::read(firmware));
  } catch (const mebots::Error& error) {
    fmt::print(stderr, "mebots-silicon-phases: {}\n", error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
