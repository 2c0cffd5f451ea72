// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmu_world/variables.hpp"
#include "mebots/state/visitor.hpp"

namespace mebots::world {

/// The sequencer's input: the drone in one inner step.
struct Situation {
  bool supported = false;  ///< the drone touches a surface below it
  bool crashed = false;    ///< the drone hit something too hard, or tipped over
  double altitude_m = 0.0;
  double climb_m_per_s = 0.0;
  double speed_m_per_s = 0.0;  ///< magnitude of the velocity along all three axes
  bool has_landed = false;     ///< result of GroundContact::has_landed()
};

/// Determines the phase of take-off and landing from the mode and the situation, and whether the motors may run.
///
///   on_ground, landed, descending --take_off--> climbing --altitude reached--> flying
///   on_ground, landed, climbing, descending --fly--> flying
///   climbing, flying --land or off--> descending --at rest on something--> landed
///   climbing, flying --come down without land or off--> grounded
///   grounded --lifted off again--> climbing (take_off), flying (fly)
///   grounded --land or off--> descending
///   any --crash--> crashed (for good)
///
/// In mode `land`, the drone sinks with running motors until a surface below touches it. This touch stops the motors.
/// Mode `off` stops them at once.
class Sequencer {
 public:
  explicit Sequencer(bool starts_on_ground) : phase_(starts_on_ground ? FlightPhase::on_ground : FlightPhase::flying) {}

  void update(FlightMode mode, double altitude_goal_m, const Situation& situation, double dt_s);

  FlightPhase phase() const { return phase_; }
  bool motors_on() const { return motors_on_; }
  /// True if the drone is at rest where it started or landed.
  bool stands() const { return phase_ == FlightPhase::on_ground || phase_ == FlightPhase::landed; }

  void visit(state::Visitor& v);

 private:
  void follow(FlightMode mode, double altitude_goal_m, const Situation& situation);
  void descend(FlightMode mode, const Situation& situation, double dt_s);

  FlightPhase phase_;
  bool motors_on_ = false;
  bool touched_down_ = false;
  double rest_s_ = 0.0;  ///< time since the drone came to rest on a surface
};

}  // namespace mebots::world
