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

/// Five range sensors to the front, back, left, right and up, like Bitcraze's Multi-ranger deck. Their distances
/// from the body's centre are in MultirangerData::offset_m. All take their samples at the same time.
class Multiranger {
 public:
  using Readings = std::array<double, direction::kCount>;

  /// Throws mebots::Error if `settings.model` is `cone`, but the drone's file does not describe a range sensor.
  Multiranger(std::shared_ptr<const RayCaster> rays, const scene::Drone& drone, const scene::MultirangerData& data,
              const Ranging::Settings& settings, std::uint64_t seed);

  /// Saved states do not contain the seed, so DroneSensors sets it before every step.
  void reseed(std::uint64_t seed) { seed_ = seed; }

  /// If samples are due at time_ns, takes them with the body at `state`.
  void update(std::int64_t time_ns, const RigidState& state, const Others& others = {});

  /// Returns the distances in the order of the words of `direction`.
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
