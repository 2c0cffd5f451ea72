// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"
#include "math/sample_clock.hpp"
#include "mebots/state/visitor.hpp"
#include "scene/scene.hpp"
#include "sensors/others.hpp"
#include "sensors/ranging.hpp"

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace mebots::world {

/// Five range sensors that measure to the front, back, left, right and up, like Bitcraze's Multi-ranger deck. Each is
/// on the surface of a box around the body's centre. All take their samples at the same time.
class Multiranger {
 public:
  using Readings = std::array<double, direction::kCount>;

  /// Throws mebots::Error if the settings require a cone, and the drone's file has no range sensor.
  Multiranger(std::shared_ptr<const RayCaster> rays, const scene::Drone& drone, const scene::MultirangerData& data,
              const Ranging::Settings& settings, std::uint64_t seed);

  /// Sets the seed for the noise of later samples. Saved states do not contain it, so DroneSensors sets it before
  /// every step.
  void reseed(std::uint64_t seed) { seed_ = seed; }

  /// Updates the sensors with the body at `state` at time_ns; takes samples when they are due.
  void update(std::int64_t time_ns, const RigidState& state, const Others& others = {});

  /// Returns the distances from the sensors in the order of the words of `direction`.
  const Readings& readings_m() const { return readings_m_; }

  void visit(state::Visitor& v);

 private:
  struct Beam {
    Eigen::Vector3d origin_B_m;
    std::vector<Eigen::Vector3d> rays_B;
  };

  Ranging ranging_;
  std::array<Beam, direction::kCount> beams_;
  SampleClock clock_;
  std::uint64_t seed_;
  Readings readings_m_{};
};

}  // namespace mebots::world
