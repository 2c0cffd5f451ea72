// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/rigid_world.hpp"

#include <span>

namespace mebots::world::test {

/// The rigid world of a scene with one drone.
class OneBody {
 public:
  explicit OneBody(const scene::Scene& scene) : bodies_(scene, std::span(&scene.drone.body_size_m, 1)) {}

  void set_mass(double mass_kg, const Eigen::Vector3d& inertia_kg_m2) { bodies_.set_mass(0, mass_kg, inertia_kg_m2); }

  /// Advances the state. Returns the touches before the step.
  const std::vector<Touch>& step(RigidState& state, const Eigen::Vector3d& force_W_n,
                                 const Eigen::Vector3d& torque_B_n_m, double dt_s, std::int64_t time_ns = 0) {
    bodies_.place(0, state, force_W_n, torque_B_n_m);
    bodies_.step(dt_s, time_ns);
    state = bodies_.state(0);
    return bodies_.touches(0);
  }

  const std::vector<Touch>& touches_at(const RigidState& state, std::int64_t time_ns = 0) {
    bodies_.place(0, state);
    bodies_.find_touches(time_ns);
    return bodies_.touches(0);
  }

 private:
  RigidWorld bodies_;
};

}  // namespace mebots::world::test
