// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"
#include "cluster/dma.hpp"
#include "energy/meter.hpp"
#include "runs/hart.hpp"

#include <cstdint>
#include <string>

namespace mebots::soc {

/// Stores the wait cycles that an access takes for request and reply together, in the clock of the requester.
struct Interconnect {
  std::uint32_t fabric_controller_to_device = 0;
  std::uint32_t fabric_controller_to_cluster = 0;
  std::uint32_t cluster_to_soc = 0;
};

/// Stores the least and the greatest ratio of measured to modelled energy. There were too few measurements for a
/// confidence interval.
struct EnergyChecks {
  double least = 0;
  double most = 0;
  std::uint32_t count = 0;
};

/// Stores the data of a chip that params/*.json defines.
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
  EnergyChecks checks;  // ratios of the whole energy, measured to modelled

  /// Returns the highest clock that a voltage allows, interpolated linearly between two points.
  double highest_clock_hz(double voltage_v) const;
  double highest_cluster_clock_hz(double voltage_v) const;
  /// Returns true if the chip allows a voltage, or a clock at a voltage. The comparison uses integer millivolts and
  /// hertz, so that the limits themselves are allowed.
  bool allows_voltage(std::uint32_t voltage_mv) const;
  bool allows(std::uint32_t clock_hz, std::uint32_t voltage_mv) const;
  bool allows_cluster(std::uint32_t clock_hz, std::uint32_t voltage_mv) const;
};

/// Reads the text of a chip file. Error messages name the file `name`. Throws Error that lists all mistakes.
Chip parse_chip(const std::string& json_text, const std::string& name);

/// Returns the chip of the AI-deck. Its data are part of this library.
const Chip& gap8();
/// Returns GAP8 with energies that were calibrated on measured currents.
const Chip& gap8_silicon();
/// Returns the chip with the set of energies that the board selects: gap8(), or gap8_silicon(), which was calibrated on
/// currents of a GAPuino.
const Chip& chip_of(const BoardDescription& board);
/// Returns the chip with a set of energies that are all multiplied by the same factor. `position` selects the factor in
/// the range of EnergyChecks: -1 selects the least factor, 0 selects 1, and 1 selects the greatest factor. Throws Error
/// that names the FMU's parameter if the name is unknown or the position is out of range.
Chip calibrated_chip(const std::string& energies, double position);

}  // namespace mebots::soc
