// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/rigid_world.hpp"
#include "flight/flight_control.hpp"
#include "flight/gate_judge.hpp"
#include "flight/ground_contact.hpp"
#include "flight/link.hpp"
#include "flight/sequencer.hpp"
#include "fmu_world/variables.hpp"
#include "mebots/state/visitor.hpp"
#include "scene/scene.hpp"
#include "sensors/camera_device.hpp"
#include "sensors/flow_sensor.hpp"
#include "sensors/imu.hpp"
#include "sensors/range_sensor.hpp"
#include "wind/dryden.hpp"

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::world {

/// Called with a sentence for each event of the flight.
using EventLog = std::function<void(std::string_view)>;

/// The effect of the calibration parameters, except the drag, which is in the drone.
struct Calibration {
  double dry_mass_factor = 1;
  std::vector<std::string> warnings;
};

/// A drone in its world: rigid body, stabiliser, take-off and landing, gates, sensors.
///
/// A step of h is divided into n = ceil(h / physics.step) equal inner steps. Rotor thrusts, wind and set-points are
/// constant during the step; the flight control runs in every inner step on the new state. Outputs are those of the end
/// of the step, except the picture, which is that of its start.
class World {
 public:
  /// Places the drone at its start. Parameters, inputs and outputs must outlive the world; the first outputs are
  /// written. Throws mebots::Error for invalid values.
  World(scene::Scene scene, const Parameters& parameters, const Inputs& inputs, Outputs& outputs, EventLog log,
        std::int64_t start_ns);

  void step(std::int64_t start_ns, std::int64_t duration_ns);

  /// Returns the last picture; empty before the first.
  std::span<const std::uint8_t> frame() const { return camera_.frame(); }

  /// Returns the scene for drawing, as from scene_text().
  std::string view() const;

  void visit(state::Visitor& v);

 private:
  void check_words() const;
  void check_inputs() const;
  void take_mass();
  void reseed();
  void set_mass(double mass_kg);
  void take_setpoint(std::int64_t time_ns, std::int64_t duration_ns);
  void take_rotor_speeds(double duration_s);
  Wrench rotors_wrench() const;
  const std::string& name_of(const Touch& touch) const;
  void check_start(std::int64_t start_ns);
  void inner_step(std::int64_t begin_ns, std::int64_t end_ns, double dt_s);
  void judge_touches(const std::vector<Touch>& touches, std::int64_t time_ns, Situation& situation);
  void report_gate(std::int64_t time_ns, const GateEvent& event, double closing_speed_m_per_s = 0.0) const;
  void report_phase(FlightPhase before, std::int64_t time_ns);
  void note_descent(std::int64_t time_ns);
  StabiliserGoal goal() const;
  void sense(std::int64_t time_ns, const RigidState& from, double dt_s);
  void write_outputs();
  void write_sensors();
  void write_estimate();
  void report(std::int64_t time_ns, std::string_view what) const;

  scene::Scene scene_;
  Calibration calibration_;
  const Parameters& in_;
  const Inputs& inputs_;
  Outputs& outputs_;
  EventLog log_;
  std::int64_t inner_step_ns_;

  std::vector<std::string> obstacle_names_;  // in the order of scene::solids_of()
  RigidWorld bodies_;
  CameraDevice camera_;
  RangeSensor range_;
  Imu imu_;
  std::optional<FlowSensor> flow_;
  Dryden gusts_;
  Link link_;
  GroundContact contact_;
  Sequencer sequencer_;
  GateJudge gates_;

  RigidState state_;
  FlightControl flight_control_;
  Setpoint setpoint_;
  RotorValues rotor_speed_rad_per_s_{};  // of the last step
  RotorValues rotor_acceleration_rad_per_s2_{};
  Eigen::Vector3d gust_W_m_per_s_ = Eigen::Vector3d::Zero();
  double mass_kg_ = std::numeric_limits<double>::quiet_NaN();
  double path_length_m_ = 0.0;
  bool came_down_ = false;  // without a landing, at some time
  double came_down_time_s_ = 0.0;
};

}  // namespace mebots::world
