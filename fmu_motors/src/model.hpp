// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmu_motors/variables.hpp"
#include "mebots/state/visitor.hpp"
#include "rotor.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string_view>

namespace mebots::motors {

/// Models four rotors with their motors. A rotor's effective voltage is its command times the bus voltage. Inputs are
/// constant during a step. Thrust, torque and speed are values at the end of the step; powers are means over the step.
class Model {
 public:
  using Log = std::function<void(std::string_view)>;

  /// Reads `resources`/rotors/<name>.json, and reports warnings to `log`. Throws mebots::Error that names parameter or
  /// file, key, value and limit.
  Model(const Parameters& parameters, const std::filesystem::path& resources, const Log& log = {});

  /// Sets the outputs at the start, when the rotors do not turn.
  void start(const Inputs& inputs, Outputs& outputs);

  /// Advances by duration_ns > 0 and sets the outputs. Throws mebots::Error if an input is out of range.
  void step(const Inputs& inputs, std::int64_t duration_ns, Outputs& outputs);

  void visit(state::Visitor& v);

  const RotorData& rotor() const { return rotor_; }

 private:
  void write(const Inputs& inputs, Outputs& outputs) const;
  double inflow_power_w(const Inputs& inputs) const;
  RotorDrive drive_of(const Inputs& inputs, double supply_v, std::size_t i) const;
  double supply_voltage_v(const Inputs& inputs) const;
  void warn_of_double_sag(double bus_v);

  Log log_;
  RotorData rotor_;
  PowerModel power_model_;
  double avionics_base_power_w_;
  bool inflow_;
  double inflow_radius_m_;
  double bus_resistance_ohm_;

  std::array<double, rotor::kCount> speed_rad_per_s_{};
  double energy_j_ = 0;
  // Mean currents from the bus through the windings, in the last step and in the step before.
  double last_current_a_ = 0;
  double earlier_current_a_ = 0;
  double last_bus_v_ = 0;
  bool warned_of_double_sag_ = false;
};

}  // namespace mebots::motors
