// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/node.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc {

inline constexpr double kFemtojoule = 1e-15;  // J

/// The conditions that a figure of the chip holds for.
struct OperatingPoint {
  double temperature_c = 25;
  double voltage_v = 1.2;
  double clock_hz = 0;  // of the domain that the component is in
};

/// A figure over temperature, voltage and frequency, as GVSoC writes it:
/// {"unit", "source", "values": {temperature: {voltage: {frequency or "any": figure}}}}. Linear between the points of
/// each axis, frequency first, then voltage, then temperature. An axis with one point holds everywhere.
class EnergyTable {
 public:
  /// The figure must have this unit; the table holds it times `scale`. Notes what is wrong in the node's document.
  static EnergyTable read(const data::Node& node, std::string_view unit, double scale);

  /// Throws Error when the point lies outside an axis of several points.
  double at(const OperatingPoint& point) const;

 private:
  using Axis = std::vector<double>;
  struct Curve {
    Axis clocks_hz;
    std::vector<double> figures;
  };
  struct Surface {
    Axis voltages_v;
    std::vector<Curve> curves;
  };
  static EnergyTable read_values(const data::Node& values, double scale);

  Axis temperatures_c_;
  std::vector<Surface> surfaces_;
  std::string name_;
};

}  // namespace mebots::soc
