// SPDX-License-Identifier: Apache-2.0
// mebots-network-bench measures the cost of an inference of the navigator network on the cluster, for several operating
// points and numbers of cores. Prints a table in Markdown.

#include "mebots/error.hpp"
#include "soc/soc.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

constexpr double kMacs = 1'679'904;  // number of multiply-accumulate operations of an inference

struct OperatingPoint {
  double voltage_v;
  double cluster_hz;
  double fabric_hz;
};

/// Interval between two reads of the chip's energy [ns]. It limits the error of the energy of the inferences, which
/// begin and end within such intervals.
constexpr std::int64_t kLookNs = 5'000;

void measure(const OperatingPoint& point, const std::string& board_path, const mebots::soc::Elf& program) {
  mebots::soc::Settings settings;
  settings.clock_hz = point.fabric_hz;
  settings.voltage_v = point.voltage_v;
  settings.cluster_clock_hz = point.cluster_hz;
  std::vector<std::string> lines;
  mebots::soc::Listeners listeners;
  listeners.faults = [](std::string_view text) { fmt::print(stderr, "{}\n", text); };
  listeners.console = [&](std::string_view line) { lines.emplace_back(line); };
  const auto board = mebots::soc::read_board(board_path);
  mebots::soc::Soc chip(board, mebots::soc::chip_of(board), settings, program, listeners);
  double begin_j = 0.0;
  unsigned cores = 0;
  unsigned inferences = 0;
  for (std::int64_t now_ns = kLookNs; chip.running() && now_ns < 2'000'000'000; now_ns += kLookNs) {
    chip.advance(now_ns);
    for (const auto& line : lines) {
      unsigned spent_ns = 0;
      if (std::sscanf(line.c_str(), "begin %u %u", &cores, &inferences) == 2) {
        begin_j = chip.energy().total_j();
      } else if (std::sscanf(line.c_str(), "end %u", &spent_ns) == 1) {
        const double seconds = spent_ns * 1e-9 / inferences;
        const double cycles = seconds * point.cluster_hz;
        fmt::print("| {:.2f} | {:.0f} | {:.0f} | {} | {:.0f} | {:.2f} | {:.3f} | {:.1f} |\n", point.voltage_v,
                   point.cluster_hz * 1e-6, point.fabric_hz * 1e-6, cores, cycles, kMacs / cycles, seconds * 1e3,
                   (chip.energy().total_j() - begin_j) * 1e6 / inferences);
      } else {
        throw mebots::Error(fmt::format("the bench firmware says: {}", line));
      }
    }
    lines.clear();
  }
  if (chip.running() || chip.exit_code() != 0) {
    throw mebots::Error(fmt::format("the bench firmware did not end well: {}", chip.fault_text()));
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::string board;
  std::string firmware;
  CLI::App app("Cycles, time and energy of an inference of the navigator network");
  app.add_option("--board", board, "Board description")->required()->check(CLI::ExistingFile);
  app.add_option("firmware", firmware, "network_bench.elf")->required()->check(CLI::ExistingFile);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  }
  try {
    const auto program = mebots::soc::Elf::read(firmware);
    fmt::print("| V | cluster MHz | FC MHz | cores | cycles | MAC/cycle | ms | uJ |\n");
    fmt::print("|---|---|---|---|---|---|---|---|\n");
    for (const OperatingPoint& point : std::vector<OperatingPoint>{
             {1.0, 50e6, 50e6}, {1.0, 87e6, 50e6}, {1.1, 131e6, 100e6}, {1.2, 175e6, 100e6}, {1.2, 175e6, 250e6}}) {
      measure(point, board, program);
    }
  } catch (const mebots::Error& error) {
    fmt::print(stderr, "mebots-network-bench: {}\n", error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
