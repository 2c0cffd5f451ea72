// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "crazyflie/controller.hpp"
#include "crazyflie/estimator.hpp"
#include "fmu_world/variables.hpp"
#include "mebots/state/visitor.hpp"
#include "scene/scene.hpp"
#include "stabiliser/stabiliser.hpp"

#include <cstdint>
#include <optional>

namespace mebots::world {

/// The sensors from which the drone's state is estimated.
struct Senses {
  const Imu& imu;
  const FlowSensor* flow;  ///< null if the drone has no flow sensor
  const RangeSensor& range;
};

/// The drone's controller: the ideal stabiliser or the Crazyflie's own controller. Its input is the true state, or a
/// state that is estimated from the sensors.
class FlightControl {
 public:
  /// If `source` requires an estimate, the drone's file must contain a flow sensor.
  FlightControl(const scene::Drone& drone, FlightController controller, Propellers propellers, StateSource source,
                const RigidState& start, std::int64_t start_ns);

  void set_mass(double mass_kg, const Eigen::Vector3d& inertia_kg_m2) { ideal_.set_mass(mass_kg, inertia_kg_m2); }

  /// Updates the estimate and the controller at time_ns, dt after the last call. `truth` is the body's state. Update
  /// the sensors before this call.
  void update(const StabiliserGoal& goal, const RigidState& truth, const Senses& senses, std::int64_t time_ns,
              double dt_s, double bus_voltage_v);

  const RotorValues& command() const;
  /// Returns the estimated state. If the controller uses the true state, returns null.
  const RigidState* estimate() const { return estimator_ ? &estimator_->state() : nullptr; }

  void visit(state::Visitor& v);

 private:
  FlightController controller_;
  Stabiliser ideal_;
  crazyflie::Controller crazyflie_;
  std::optional<crazyflie::Estimator> estimator_;
};

}  // namespace mebots::world
