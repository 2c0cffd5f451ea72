// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/hart.hpp"

#include <cstdint>
#include <string>

namespace mebots::soc {

/// What params/*.json says about a chip.
struct Chip {
  Timing timing;
  double minimum_clock_hz = 0;
  double lowest_voltage_v = 0;
  double highest_voltage_v = 0;
  double clock_at_lowest_voltage_hz = 0;
  double clock_at_highest_voltage_hz = 0;
  double reference_voltage_v = 0;
  InstructionEnergy instruction_energy;  // at the reference voltage
  double memory_access_j = 0;            // at the reference voltage
  double device_access_j = 0;            // at the reference voltage
  double core_leakage_w = 0;             // always
  double core_clock_gated_w = 0;         // added while the core sleeps
  double memory_leakage_w_per_byte = 0;  // always

  /// The highest clock at a voltage: linear between the two given points.
  double highest_clock_hz(double voltage_v) const;
  /// Whether a voltage is allowed, and a clock at it. In millivolts and hertz, exact at the limits.
  bool allows(std::uint32_t clock_hz, std::uint32_t voltage_mv) const;
};

/// Reads a chip file's text; `name` stands in errors.
Chip parse_chip(const std::string& json_text, const std::string& name);

/// The chip of the AI-deck, from the data built into this library.
const Chip& gap8();

}  // namespace mebots::soc
