// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"
#include "cluster/dma.hpp"
#include "energy/meter.hpp"
#include "runs/hart.hpp"

#include <cstdint>
#include <string>

namespace mebots::soc {

/// Wait cycles of an access for both directions, in the clock of the requester.
struct Interconnect {
  std::uint32_t fabric_controller_to_device = 0;
  std::uint32_t fabric_controller_to_cluster = 0;
  std::uint32_t cluster_to_soc = 0;
};

/// Range of measured energies, relative to the modelled ones. There were too few measurements for a confidence
/// interval.
struct EnergyChecks {
  double least = 0;
  double most = 0;
  std::uint32_t count = 0;
};

/// Data of a chip from params/*.json.
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
  EnergyChecks checks;  // of the sum of energies

  /// Returns the highest clock at a voltage, interpolated linearly between two points.
  double highest_clock_hz(double voltage_v) const;
  double highest_cluster_clock_hz(double voltage_v) const;
  /// True if a voltage is allowed, or a clock at a voltage. The comparison is exact at the limits, because it uses
  /// millivolts and hertz.
  bool allows_voltage(std::uint32_t voltage_mv) const;
  bool allows(std::uint32_t clock_hz, std::uint32_t voltage_mv) const;
  bool allows_cluster(std::uint32_t clock_hz, std::uint32_t voltage_mv) const;
};

/// Reads the text of a chip file. `name` is its name in messages. Throws Error that lists all mistakes.
Chip parse_chip(const std::string& json_text, const std::string& name);

/// Returns the chip of the AI-deck, from data built into this library.
const Chip& gap8();
/// Returns GAP8 with energies that were calibrated on measured currents.
const Chip& gap8_silicon();
/// Returns the chip with the board's set of energies: gap8(), or gap8_silicon(), which was calibrated on currents of a
/// GAPuino.
const Chip& chip_of(const BoardDescription& board);
/// Returns the chip with a set of energies, all multiplied by one factor. `position` selects the factor in the range of
/// EnergyChecks: -1 selects the least factor, 0 selects 1, and 1 selects the greatest factor. Throws Error that names
/// the FMU's parameter if the name is unknown or the position is out of range.
Chip calibrated_chip(const std::string& energies, double position);

}  // namespace mebots::soc
