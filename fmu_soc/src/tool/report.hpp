// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "observe/cycle_stack.hpp"
#include "soc/soc.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mebots::soc::tool {

struct ChipReport {
  struct Cores {
    std::string name;
    unsigned cores = 1;
    std::uint64_t instructions = 0;  ///< sum over these cores, like `cycles`
    std::uint64_t cycles = 0;
    std::optional<std::uint64_t> refills;  ///< refills of the instruction cache, if there is one
    std::uint64_t waited_cycles = 0;       ///< cycles of waiting for refills
  };
  struct Part {
    std::string name;
    double energy_j = 0;
    std::string text;
  };

  std::vector<Cores> cores;  ///< the fabric controller, then the cluster if there is one
  double time_s = 0;
  double asleep_s = 0;
  double chip_j = 0;
  std::vector<Part> parts;  ///< parts of the chip, whose sum is chip_j
  std::size_t checks = 0;   ///< number of programs with measured energies
  double least_j = 0;       ///< chip_j times the least ratio of measured to modelled energy
  double most_j = 0;
  std::vector<Part> devices;  ///< devices of the board; a regulator contains the energy of its loads
  double host_mips = 0;
  std::optional<std::uint32_t> tohost;
  std::optional<int> exit_code;
};

ChipReport report_of(const Soc& soc, double host_mips, std::optional<std::uint32_t> tohost);

void print(const ChipReport& report);
/// Returns the report as JSON, in SI units.
std::string json_text(const ChipReport& report);
/// Returns the report as JSON, with the cycles of each core and function by cause, and the use of the banks.
std::string json_text(const ChipReport& report, const observe::CycleStack& cycles);

}  // namespace mebots::soc::tool
