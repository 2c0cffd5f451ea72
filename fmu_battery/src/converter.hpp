// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace mebots::battery {

/// Models a DC/DC converter between the bus and a load, or between a source and the bus. The efficiency over the output
/// current is a table, linear between its points and constant outside them.
class Converter {
 public:
  /// Creates a connection without a converter: its efficiency is 1.
  Converter() = default;

  /// Creates a converter with a table of its efficiency. `output_current_a` must rise from a value >= 0; `efficiency`
  /// must be in (0, 1]. Both must have the same size >= 1.
  Converter(std::string name, double output_voltage_v, std::vector<double> output_current_a,
            std::vector<double> efficiency);

  const std::string& name() const { return name_; }

  /// Returns the efficiency at an output power >= 0.
  double efficiency(double output_power_w) const;

  /// Returns the input power [W] for an output power [W, >= 0].
  double input_power_w(double output_power_w) const { return output_power_w / efficiency(output_power_w); }

  /// Inverse of input_power_w(): returns the output power [W] for an input power [W, >= 0].
  double output_power_w(double input_power_w) const;

 private:
  std::string name_ = "direct";
  double output_voltage_v_ = 1;
  std::vector<double> output_current_a_;  // empty if the efficiency is always 1
  std::vector<double> efficiency_;
};

/// Reads all converters of a converters.json. Throws mebots::Error that lists all mistakes.
std::map<std::string, Converter> load_converters(const std::filesystem::path& file);

/// Reads the converter `name` of a converters.json. `variable` is the name of the parameter that selects the converter,
/// for messages. Throws mebots::Error that names file, key, value and limit, or the known converters.
Converter load_converter(const std::filesystem::path& file, const std::string& name, const std::string& variable);

}  // namespace mebots::battery
