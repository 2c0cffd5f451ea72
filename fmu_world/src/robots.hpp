// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"
#include "fmu_world/variables.hpp"
#include "scene/scene.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mebots::world {

/// The robots of the world except drones, such as rovers. Another FMU moves them: their poses and velocities are
/// inputs. During a step, a robot moves at constant velocity from its pose at the start. The robots have no state,
/// because each step reads the inputs.
class Robots {
 public:
  /// Throws mebots::Error if the parameters require robots but the scene describes none, or if an input is not finite.
  Robots(const scene::Scene& scene, const Parameters& parameters, const Inputs& inputs, std::int64_t start_ns);

  std::size_t count() const { return count_; }

  /// Reads the inputs of a step. Throws mebots::Error if a value is not finite.
  void begin_step(std::int64_t start_ns);

  /// Appends the parts of all robots as solids, in the order of the robots.
  void add_solids(std::vector<scene::Solid>& solids) const;
  /// Updates the robots' states, and the poses of their solids, which start at index `first`.
  void place(std::int64_t time_ns, std::vector<scene::Solid>& solids, std::size_t first,
             std::vector<RigidState>& states) const;
  void write_outputs(std::int64_t time_ns, Outputs& outputs) const;

 private:
  RigidState at(std::size_t robot, std::int64_t time_ns) const;
  double yaw_rad(std::size_t robot, std::int64_t time_ns) const;
  double since_start_s(std::int64_t time_ns) const { return static_cast<double>(time_ns - start_ns_) * 1e-9; }

  const Inputs& in_;
  std::size_t count_;
  std::vector<scene::Solid> parts_;  // of one robot, in its frame
  std::int64_t start_ns_ = 0;        // of the present step
};

}  // namespace mebots::world
