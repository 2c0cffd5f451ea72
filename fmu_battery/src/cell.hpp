// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "curve.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::battery {

/// Values of the equivalent circuit's elements at one state of charge:
/// open-circuit source, series resistance and two parallel RC pairs in one loop.
struct Circuit {
  double open_circuit_v;
  double series_ohm;
  double pair1_ohm;
  double pair1_farad;
  double pair2_ohm;
  double pair2_farad;
};

/// A cell as its data file describes it (fmu_battery/README.md documents the format).
struct Cell {
  std::string name;
  double mass_kg = 0;
  double capacity_c = 0;                // charge between s = 1 and s = 0
  double cut_off_voltage_v = 0;         // the protection opens below it
  double cut_off_delay_s = 0;           // after so long below it
  double release_voltage_v = 0;         // an open protection closes when a charger lifts the terminals to it
  double continuous_current_a = 0;      // above it over_current is raised; nothing else happens
  double self_discharge_current_a = 0;  // flows while s > 0
  double hold_below_soc = 0;            // R and C keep their value at this s below it
  Curve open_circuit_v;
  Curve series_ohm;
  Curve pair1_ohm;
  Curve pair1_farad;
  Curve pair2_ohm;
  Curve pair2_farad;

  std::vector<std::string> warnings;  // positions without an interval in the file

  Circuit circuit_at(double s) const;
};

/// Positions in the intervals of the file's quantities, from -1 to 1: 0 is the value.
struct CellPositions {
  double resistance = 0;  // of resistance_factor; capacitances change inversely, so that time constants stay
  double capacity = 0;    // of capacity_factor or, if that has no interval, of capacity
  double cut_off_voltage = 0;
  double cut_off_delay = 0;
};

/// Reads and checks a cell file. Throws mebots::Error naming file, key, value and limit when a key is missing
/// or unknown or a type or unit is wrong. So it does when mass, capacity, a resistance or a capacitance is not
/// positive, the open-circuit voltage falls with rising s, or the cut-off or the release voltage is out of order: it
/// must be cut-off < release <= voltage of the full cell. Throws for a position outside -1 to 1.
Cell load_cell(const std::filesystem::path& path, const CellPositions& positions = {});

/// Current at the terminals [A, positive = discharge] when they give `power_w` (negative = charging) and the
/// voltage behind the series resistance is `source_v`: the smaller root of R i^2 - E i + P = 0.
/// Beyond the power that the circuit can give, E^2 / (4 R), it stays at the point of greatest power.
double terminal_current_a(double source_v, double series_ohm, double power_w);

/// The greatest terminal power [W] at which the terminal voltage is not below `cut_off_v`.
double power_limit_w(double source_v, double series_ohm, double cut_off_v);

}  // namespace mebots::battery
