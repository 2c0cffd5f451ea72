// SPDX-License-Identifier: Apache-2.0
#include "flight/sequencer.hpp"

#include <cmath>

namespace mebots::world {
namespace {

constexpr double kReachedAltitude_m = 0.05;
constexpr double kReachedClimb_m_per_s = 0.1;
constexpr double kRestSpeed_m_per_s = 0.05;
constexpr double kRestTime_s = 0.2;

/// True if the motors may run in this phase. Mode `off` or a touch-down can still stop them.
bool is_powered(FlightPhase phase) {
  return phase == FlightPhase::climbing || phase == FlightPhase::flying || phase == FlightPhase::descending ||
         phase == FlightPhase::grounded;
}

}  // namespace

void Sequencer::update(FlightMode mode, double altitude_goal_m, const Situation& situation, double dt_s) {
  if (situation.crashed) phase_ = FlightPhase::crashed;
  if (phase_ == FlightPhase::crashed) {
    motors_on_ = false;
    return;
  }
  follow(mode, altitude_goal_m, situation);
  if (phase_ == FlightPhase::descending) {
    descend(mode, situation, dt_s);
  } else {
    touched_down_ = false;
    rest_s_ = 0.0;
  }
  motors_on_ = is_powered(phase_) && mode != FlightMode::off && !touched_down_;
}

void Sequencer::follow(FlightMode mode, double altitude_goal_m, const Situation& situation) {
  switch (mode) {
    case FlightMode::take_off:
      if (phase_ == FlightPhase::on_ground || phase_ == FlightPhase::landed || phase_ == FlightPhase::descending ||
          (phase_ == FlightPhase::grounded && !situation.has_landed)) {
        phase_ = FlightPhase::climbing;
      }
      if (phase_ == FlightPhase::climbing && std::abs(altitude_goal_m - situation.altitude_m) < kReachedAltitude_m &&
          std::abs(situation.climb_m_per_s) < kReachedClimb_m_per_s) {
        phase_ = FlightPhase::flying;
      }
      break;
    case FlightMode::fly:
      phase_ = FlightPhase::flying;
      break;
    case FlightMode::off:
    case FlightMode::land:
      if (is_powered(phase_)) phase_ = FlightPhase::descending;
      return;
  }
  if (situation.has_landed) phase_ = FlightPhase::grounded;
}

void Sequencer::descend(FlightMode mode, const Situation& situation, double dt_s) {
  if (mode == FlightMode::land && situation.supported) touched_down_ = true;
  const bool at_rest = situation.supported && situation.speed_m_per_s < kRestSpeed_m_per_s;
  rest_s_ = at_rest ? rest_s_ + dt_s : 0.0;
  if (rest_s_ >= kRestTime_s) phase_ = FlightPhase::landed;
}

void Sequencer::visit(state::Visitor& v) {
  v("phase", phase_);
  v("motors_on", motors_on_);
  v("touched_down", touched_down_);
  v("rest_s", rest_s_);
}

}  // namespace mebots::world
