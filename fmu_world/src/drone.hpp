// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/downwash.hpp"
#include "dynamics/rigid_world.hpp"
#include "flight/flight_control.hpp"
#include "flight/gate_judge.hpp"
#include "flight/ground_contact.hpp"
#include "flight/link.hpp"
#include "flight/sequencer.hpp"
#include "fmu_world/variables.hpp"
#include "mebots/state/visitor.hpp"
#include "scene/scene.hpp"
#include "sensors/drone_sensors.hpp"
#include "view/scene_text.hpp"

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::world {

/// Called with a sentence that describes an event of the flight.
using EventLog = std::function<void(std::string_view)>;

/// The model, parameters, inputs and outputs of a drone. Parameters, inputs and outputs must outlive the drone.
struct DroneSetup {
  std::string name;  ///< "drone[2]", for messages; empty for the drone of an FMU of one
  scene::Drone model;
  const DroneParameters& parameters;
  const DroneInputs& inputs;
  DroneOutputs& outputs;
};

/// References to the parts of the world that a drone uses.
struct Around {
  const scene::Scene& scene;
  const std::vector<std::string>& obstacle_names;  ///< in the order of scene::solids_of()
  const Parameters& parameters;
  RigidWorld& bodies;
  const EventLog& log;
  Views views;
};

/// The result of the calibration parameters: the factor of the dry mass, and warnings for the user. The factor of the
/// drag is not stored here, because calibrate() applies it to the drone's model.
struct Calibration {
  double dry_mass_factor = 1;
  std::vector<std::string> warnings;
};

/// A drone: body, stabiliser, take-off and landing, gates, sensors, camera and link.
///
/// In a step, the world calls begin_step(), then push(), move(), judge() and control() for each inner step, and
/// write_outputs() at the end. Each function is called for all drones before the next function. Between push() and
/// move(), the world moves the bodies.
class Drone {
 public:
  /// Places the drone at its start. Throws mebots::Error for invalid values.
  Drone(const Around& around, std::size_t index, DroneSetup setup, std::int64_t start_ns);

  /// Writes the first outputs. Call RigidWorld::find_touches() before this function. Throws mebots::Error if the drone
  /// overlaps another object.
  void start(std::int64_t start_ns, const Others& others);

  /// Reads the inputs, and takes a picture if one is requested.
  void begin_step(std::int64_t start_ns, std::int64_t duration_ns, const Others& others);
  /// Applies the forces to the body.
  void push(const Eigen::Vector3d& wind_W_m_per_s, const DownwashForce& downwash);
  /// Reads the body's new state.
  void move();
  /// Evaluates contacts and gates, and updates the phase of the flight, such as `climbing` or `landed`.
  void judge(std::int64_t end_ns, double dt_s);
  /// Updates the sensors, then the flight control.
  void control(std::int64_t end_ns, double dt_s, const Others& others);
  void write_outputs();

  const RigidState& state() const { return state_; }
  double rotor_radius_m() const { return in_.rotors_radius_m; }
  const std::string& name() const { return name_; }
  const CameraDevice& camera() const { return sensors_.camera(); }
  /// Returns the drone's contact box at its current pose.
  scene::Solid box() const;
  ViewedDrone view() const;

  void visit(state::Visitor& v);

 private:
  void check_words() const;
  void check_inputs() const;
  void take_mass();
  void set_mass(double mass_kg);
  void take_setpoint(std::int64_t time_ns, std::int64_t duration_ns);
  void take_rotor_speeds(double duration_s);
  Wrench rotors_wrench() const;
  Eigen::Vector3d contact_force_W(double dt_s) const;
  std::string name_of(const Touch& touch) const;
  void judge_touches(const std::vector<Touch>& touches, std::int64_t time_ns, Situation& situation);
  void report_gate(std::int64_t time_ns, const GateEvent& event, double closing_speed_m_per_s = 0.0) const;
  void report_phase(FlightPhase before, std::int64_t time_ns);
  void note_descent(std::int64_t time_ns);
  StabiliserGoal goal() const;
  void write_estimate();
  void report(std::int64_t time_ns, std::string_view what) const;
  void log(std::string_view text) const;

  Around around_;
  std::size_t index_;
  std::string name_;
  scene::Drone model_;
  Calibration calibration_;
  const Parameters& shared_;
  const DroneParameters& in_;
  const DroneInputs& inputs_;
  DroneOutputs& outputs_;

  RigidState state_;
  // Values of the current inner step. They are not part of the saved state.
  RigidState from_;                // before move()
  Eigen::Vector3d air_force_W_n_;  // of rotors, drag and downwash
  DroneSensors sensors_;
  Link link_;
  GroundContact contact_;
  Sequencer sequencer_;
  GateJudge gates_;
  FlightControl flight_control_;

  Setpoint setpoint_;
  RotorValues rotor_speed_rad_per_s_{};  // of the last step
  RotorValues rotor_acceleration_rad_per_s2_{};
  double mass_kg_ = std::numeric_limits<double>::quiet_NaN();
  double path_length_m_ = 0.0;
  bool came_down_ = false;  // without a landing, at some time
  double came_down_time_s_ = 0.0;
};

}  // namespace mebots::world
