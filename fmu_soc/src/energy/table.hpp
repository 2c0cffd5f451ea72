// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/node.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc {

inline constexpr double kFemtojoule = 1e-15;  // J

struct OperatingPoint {
  double temperature_c = 25;
  double voltage_v = 1.2;
  double clock_hz = 0;  // frequency in the component's clock domain
};

/// An energy or power that depends on temperature, voltage and frequency, in GVSoC's format: {"unit", "source",
/// "values": {temperature: {voltage: {frequency or "any": value}}}}. Interpolates linearly between the points of an
/// axis: over frequency, then voltage, then temperature. The value is constant along an axis with one point.
class EnergyTable {
 public:
  /// Reads a table whose unit must be `unit`, and multiplies its values by `scale`. Reports mistakes to the document
  /// that contains the node.
  static EnergyTable read(const data::Node& node, std::string_view unit, double scale);

  /// Returns the value at an operating point. Throws Error if the point is outside an axis with several points.
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
