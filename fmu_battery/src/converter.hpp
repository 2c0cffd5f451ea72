// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace mebots::battery {

/// A DC/DC converter between the cell's bus and a load, or between a source and the bus. Its efficiency depends
/// on its output current: linear between the points of a table, held at the first and last value outside.
class Converter {
 public:
  /// No converter at all: efficiency 1.
  Converter() = default;

  /// `output_current_a` rises and is not negative, `efficiency` is in (0, 1]; both have the same size >= 1.
  Converter(std::string name, double output_voltage_v, std::vector<double> output_current_a,
            std::vector<double> efficiency);

  const std::string& name() const { return name_; }

  /// Efficiency when the output gives `output_power_w` >= 0.
  double efficiency(double output_power_w) const;

  /// Power taken at the input [W] for a given power at the output [W, >= 0].
  double input_power_w(double output_power_w) const { return output_power_w / efficiency(output_power_w); }

  /// Power at the output [W] for a given power at the input [W, >= 0]: the inverse of input_power_w.
  double output_power_w(double input_power_w) const;

 private:
  std::string name_ = "direct";
  double output_voltage_v_ = 1;
  std::vector<double> output_current_a_;  // empty: efficiency 1
  std::vector<double> efficiency_;
};

/// Every converter of a converters.json. Throws mebots::Error naming everything that is wrong in it.
std::map<std::string, Converter> load_converters(const std::filesystem::path& file);

/// The converter called `name` in a converters.json. `variable` is the parameter that asked for it.
/// Throws mebots::Error naming file, key, value and limit, or the known names.
Converter load_converter(const std::filesystem::path& file, const std::string& name, const std::string& variable);

}  // namespace mebots::battery
