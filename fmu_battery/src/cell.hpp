// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "curve.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::battery {

/// Values of the circuit's elements at one state of charge. The circuit consists of an open-circuit source, a series
/// resistance and two RC pairs in series.
struct Circuit {
  double open_circuit_v;
  double series_ohm;
  double pair1_ohm;
  double pair1_farad;
  double pair2_ohm;
  double pair2_farad;
};

/// Data of a cell. fmu_battery/README.md documents the format of the data file.
struct Cell {
  std::string name;
  double mass_kg = 0;
  double capacity_c = 0;         // charge that the cell delivers from s = 1 to s = 0
  double cut_off_voltage_v = 0;  // the protection opens if the terminal voltage stays below this voltage
  double cut_off_delay_s = 0;    // time below the cut-off voltage after which the protection opens
  double release_voltage_v = 0;  // an open protection closes when a charger raises the terminal voltage to this voltage
  double continuous_current_a = 0;      // above this current, the output over_current is true
  double self_discharge_current_a = 0;  // flows while s > 0
  double hold_below_soc = 0;            // below this s, R and C are constant
  Curve open_circuit_v;
  Curve series_ohm;
  Curve pair1_ohm;
  Curve pair1_farad;
  Curve pair2_ohm;
  Curve pair2_farad;

  std::vector<std::string> warnings;  // quantities with a position, but without an interval in the file

  Circuit circuit_at(double s) const;
};

/// Positions of quantities in their intervals in the file: -1 and 1 are the ends of an interval, 0 is the nominal
/// value.
struct CellPositions {
  double resistance = 0;  // for resistance_factor; capacitances change inversely, which keeps the time constants
  double capacity = 0;    // for capacity_factor or, without an interval of that factor, for capacity
  double cut_off_voltage = 0;
  double cut_off_delay = 0;
};

/// Reads and checks a cell file. Throws mebots::Error that names file, key, value and limit if
///
///   - a key is missing or unknown, or a type or unit is wrong,
///   - mass, capacity, a resistance or a capacitance is not positive,
///   - the open-circuit voltage decreases with rising s,
///   - cut-off < release <= voltage of the full cell does not hold,
///   - a position is outside -1 to 1.
Cell load_cell(const std::filesystem::path& path, const CellPositions& positions = {});

/// Returns the terminal current [A, positive = discharge] for a terminal power P (negative = charging) and a voltage E
/// before the series resistance R: the smaller root of R i^2 - E i + P = 0. If P exceeds the maximum, E^2 / (4 R),
/// returns the current at the maximum.
double terminal_current_a(double source_v, double series_ohm, double power_w);

/// Returns the greatest terminal power [W] for which the terminal voltage is at least `cut_off_v`.
double power_limit_w(double source_v, double series_ohm, double cut_off_v);

}  // namespace mebots::battery
