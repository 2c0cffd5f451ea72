// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"
#include "cluster/dma.hpp"
#include "energy/meter.hpp"
#include "runs/hart.hpp"

#include <cstdint>
#include <string>

namespace mebots::soc {

/// Wait cycles of an access for request and reply together, in the clock of the requester.
struct Interconnect {
  std::uint32_t fabric_controller_to_device = 0;
  std::uint32_t fabric_controller_to_cluster = 0;
  std::uint32_t cluster_to_soc = 0;
};

/// Least and greatest ratio of measured to modelled energy. There are too few measurements for a confidence interval.
struct EnergyChecks {
  double least = 0;
  double most = 0;
  std::uint32_t count = 0;
};

/// Data of a chip, as defined by params/*.json.
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
  double wake_up_s = 0;  // time from the interrupt that ends retention sleep to the first instruction [s]
  InstructionEnergy instruction_energy;  // energies at the chip's reference clock and voltage
  EnergyTables energy;
  EnergyChecks checks;  // ratios of the chip's whole energy, measured to modelled

  /// Return the highest clock at a voltage, interpolated linearly.
  double highest_clock_hz(double voltage_v) const;
  double highest_cluster_clock_hz(double voltage_v) const;
  /// Return true if the chip allows a voltage, or a clock at a voltage. The comparison uses integers, so that the
  /// limits themselves are allowed.
  bool allows_voltage(std::uint32_t voltage_mv) const;
  bool allows(std::uint32_t clock_hz, std::uint32_t voltage_mv) const;
  bool allows_cluster(std::uint32_t clock_hz, std::uint32_t voltage_mv) const;
};

/// Parses a chip file. Throws Error that names the file `name` and lists all mistakes.
Chip parse_chip(const std::string& json_text, const std::string& name);

/// Returns GAP8, the chip of the AI-deck.
const Chip& gap8();
/// Returns GAP8 with energies that were calibrated on currents of a GAPuino.
const Chip& gap8_silicon();
/// Returns the chip with the energies that the board selects: gap8() or gap8_silicon().
const Chip& chip_of(const BoardDescription& board);
/// Returns the chip with all energies multiplied by one factor from the range of EnergyChecks. `position` selects this
/// factor: -1 the least, 0 the factor 1, and 1 the greatest. Throws Error that names the FMU's parameter if the name is
/// unknown or the position is out of range.
Chip calibrated_chip(const std::string& energies, double position);

}  // namespace mebots::soc
