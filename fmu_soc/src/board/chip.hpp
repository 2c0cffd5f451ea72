// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"
#include "cluster/dma.hpp"
#include "energy/meter.hpp"
#include "runs/hart.hpp"

#include <cstdint>
#include <string>

namespace mebots::soc {

/// Cycles that an access waits for its way there and back, in the clock of who asks.
struct Interconnect {
  std::uint32_t fabric_controller_to_device = 0;
  std::uint32_t fabric_controller_to_cluster = 0;
  std::uint32_t cluster_to_soc = 0;
};

/// Between which multiples of these energies silicon took, in so few checks that it is no confidence interval.
struct EnergyChecks {
  double least = 0;
  double most = 0;
  std::uint32_t count = 0;
};

/// What params/*.json says about a chip.
struct Chip {
  Timing timing;
  double minimum_clock_hz = 0;
  double lowest_voltage_v = 0;
  double highest_voltage_v = 0;
  double clock_at_lowest_voltage_hz = 0;
  double clock_at_highest_voltage_hz = 0;
  double cluster_clock_at_lowest_voltage_hz = 0;
  double cluster_clock_at_highest_voltage_hz = 0;
  std::uint32_t voltage_step_mv = 1;
  Interconnect interconnect;
  DmaTiming dma;
  double wake_up_s = 0;                  // from the interrupt that ends retention sleep to the first instruction
  InstructionEnergy instruction_energy;  // at the reference point
  EnergyTables energy;
  EnergyChecks checks;  // of its sum

  /// The highest clocks at a voltage: linear between the two given points.
  double highest_clock_hz(double voltage_v) const;
  double highest_cluster_clock_hz(double voltage_v) const;
  /// Whether a voltage is allowed, and a clock at it. In millivolts and hertz, exact at the limits.
  bool allows_voltage(std::uint32_t voltage_mv) const;
  bool allows(std::uint32_t clock_hz, std::uint32_t voltage_mv) const;
  bool allows_cluster(std::uint32_t clock_hz, std::uint32_t voltage_mv) const;
};

/// Reads a chip file's text; `name` stands in errors. Throws Error naming everything that is wrong in it.
Chip parse_chip(const std::string& json_text, const std::string& name);

/// The chip of the AI-deck, from the data built into this library.
const Chip& gap8();
/// GAP8 with energies that were calibrated on measured currents.
const Chip& gap8_silicon();
/// The chip with the energies that the board names: gap8()'s own, or gap8_silicon's, which were calibrated on currents
/// of a GAPuino.
const Chip& chip_of(const BoardDescription& board);
/// The chip with the energies of this name, every one multiplied: `position` is that of the factor in the interval of
/// the checks, from -1 (least) over 0 (1) to 1 (most). Throws Error naming the FMU's parameter for an unknown name and
/// for a position outside.
Chip calibrated_chip(const std::string& energies, double position);

}  // namespace mebots::soc
