// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "drone.hpp"
#include "dynamics/neural_downwash.hpp"
#include "dynamics/rigid_world.hpp"
#include "fmu_world/variables.hpp"
#include "mebots/state/visitor.hpp"
#include "robots.hpp"
#include "scene/scene.hpp"
#include "wind/dryden.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mebots::world {

/// A world with its drones, robots and wind.
///
/// A step of h is divided into n = ceil(h / physics.step) equal inner steps. Rotor thrusts, the wind input and
/// set-points are constant during the step. The flight control runs in every inner step with the new state. Outputs
/// describe the end of the step, except the picture, which shows the start of the step.
///
/// A drone that touches no other drone has the same bits as in a world without other drones. The noise of drone i
/// depends only on the seed and on i.
class World {
 public:
  /// Places the drones at their starts and writes the first outputs. Parameters, inputs and outputs must outlive the
  /// world. Throws mebots::Error for invalid values. `downwash_networks` is the content of the file that the parameter
  /// `downwash.networks` names. If it has a value, it replaces the formula of downwash().
  World(scene::Scene scene, const Parameters& parameters, const Inputs& inputs, Outputs& outputs,
        std::vector<DroneSetup> drones, EventLog log, std::int64_t start_ns,
        std::optional<scene::DownwashNetworks> downwash_networks = {});

  void step(std::int64_t start_ns, std::int64_t duration_ns);

  /// Returns the camera of a drone. If the world has no drone with this index, returns null.
  const CameraDevice* camera(std::size_t drone = 0) const;

  /// Returns the result of scene_text() for this world.
  std::string view() const;

  void visit(state::Visitor& v);

 private:
  template <typename Act>
  void for_each_drone(Act&& act);
  void check_wind() const;
  void inner_step(std::int64_t begin_ns, std::int64_t end_ns, double dt_s);
  void find_downwash();
  double networks_force_W_n(std::size_t drone);
  void move_robots();
  void note_touches();
  void take_states(std::int64_t time_ns);
  void write_robots(std::int64_t end_ns);
  /// Returns the data of other drones and of robots that the sensors of a drone need.
  Others others_of(std::size_t drone) const { return {boxes_, states_, drone}; }

  scene::Scene scene_;
  const Parameters& in_;
  const Inputs& inputs_;
  Outputs& outputs_;
  EventLog log_;
  std::int64_t inner_step_ns_;

  std::vector<std::string> obstacle_names_;  // in the order of scene::solids_of()
  Robots robots_;
  RigidWorld bodies_;
  Dryden gusts_;
  std::vector<std::unique_ptr<Drone>> drones_;
  std::vector<scene::Solid> boxes_;  // of the drones, then the parts of the robots; empty with one drone and no robot
  std::vector<RigidState> states_;   // of drones and robots, likewise
  std::vector<bool> touched_;        // robots that touched something in this step
  std::optional<NeuralDownwash> networks_;
  std::vector<DownwashForce> downwash_;  // on each drone
  Eigen::Vector3d gust_W_m_per_s_ = Eigen::Vector3d::Zero();
};

}  // namespace mebots::world
