// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "curve.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::battery {

/// Contains the values of the equivalent circuit's elements at one state of charge. The circuit has an open-circuit
/// source, a series resistance and two RC pairs in series.
struct Circuit {
  double open_circuit_v;
  double series_ohm;
  double pair1_ohm;
  double pair1_farad;
  double pair2_ohm;
  double pair2_farad;
};

/// Describes a cell, as read from its data file (fmu_battery/README.md documents the format).
struct Cell {
  std::string name;
  double mass_kg = 0;
  double capacity_c = 0;                // charge that the cell delivers from s = 1 to s = 0
  double cut_off_voltage_v = 0;         // the protection opens if the terminal voltage stays below it
  double cut_off_delay_s = 0;           // time below the cut-off voltage after which the protection opens
  double release_voltage_v = 0;         // an open protection closes when a charger raises the terminal voltage to it
  double continuous_current_a = 0;      // above it, the output over_current is true; no other effect
  double self_discharge_current_a = 0;  // flows while s > 0
  double hold_below_soc = 0;            // below this s, R and C keep the values that they have at it
  Curve open_circuit_v;
  Curve series_ohm;
  Curve pair1_ohm;
  Curve pair1_farad;
  Curve pair2_ohm;
  Curve pair2_farad;

  std::vector<std::string> warnings;  // positions without an interval in the file

  Circuit circuit_at(double s) const;
};

/// Contains positions of quantities in their intervals in the file: -1 and 1 are the ends of an interval, 0 is the
/// value itself.
struct CellPositions {
  double resistance = 0;  // of resistance_factor; capacitances change inversely, so time constants stay the same
  double capacity = 0;    // of capacity_factor or, if that has no interval, of capacity
  double cut_off_voltage = 0;
  double cut_off_delay = 0;
};

/// Reads and checks a cell file. Throws mebots::Error that names file, key, value and limit if a key is missing or
/// unknown, if a type or unit is wrong, or if mass, capacity, a resistance or a capacitance is not positive. Also
/// throws if the open-circuit voltage decreases with rising s, or if cut-off < release <= voltage of the full cell
/// does not hold. Also throws for a position outside -1 to 1.
Cell load_cell(const std::filesystem::path& path, const CellPositions& positions = {});

/// Returns the terminal current [A, positive = discharge] for a terminal power `power_w` (negative = charging) and a
/// voltage `source_v` before the series resistance: the smaller root of R i^2 - E i + P = 0. If the power exceeds the
/// maximum, E^2 / (4 R), returns the current of the maximum.
double terminal_current_a(double source_v, double series_ohm, double power_w);

/// Returns the greatest terminal power [W] for which the terminal voltage is at least `cut_off_v`.
double power_limit_w(double source_v, double series_ohm, double cut_off_v);

}  // namespace mebots::battery
