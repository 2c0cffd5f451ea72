// SPDX-License-Identifier: Apache-2.0
#include "flight/flight_control.hpp"

#include "mebots/assert.hpp"

namespace mebots::world {

FlightControl::FlightControl(const scene::Drone& drone, FlightController controller, Propellers propellers,
                             StateSource source, const RigidState& start, std::int64_t start_ns)
    : controller_(controller), ideal_(drone), crazyflie_(propellers) {
  if (source == StateSource::truth) return;
  MEBOTS_ASSERT(drone.flow.has_value());  // the world's constructor checks this
  estimator_.emplace(*drone.flow, start, start_ns);
}

void FlightControl::update(const StabiliserGoal& goal, const RigidState& truth, const Senses& senses,
                           std::int64_t time_ns, double dt_s, double bus_voltage_v) {
  if (estimator_) {
    MEBOTS_ASSERT(senses.flow != nullptr);
    estimator_->update(time_ns, senses.imu, *senses.flow, senses.range, goal.motors_on);
  }
  const RigidState& state = estimator_ ? estimator_->state() : truth;
  if (controller_ == FlightController::ideal) {
    ideal_.update(goal, state, dt_s);
  } else {
    crazyflie_.update(goal, state, time_ns, bus_voltage_v);
  }
}

const RotorValues& FlightControl::command() const {
  return controller_ == FlightController::ideal ? ideal_.command() : crazyflie_.command();
}

void FlightControl::visit(state::Visitor& v) {
  if (controller_ == FlightController::ideal) {
    v("ideal", ideal_);
  } else {
    v("crazyflie", crazyflie_);
  }
  if (estimator_) v("estimator", *estimator_);
}

}  // namespace mebots::world
