// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"
#include "mebots/state/visitor.hpp"
#include "scene/scene.hpp"

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace mebots::world {

/// An optical flow sensor at the body's centre along the body's -z axis, like PixArt's PMW3901 on Bitcraze's flow deck.
/// The middle of the picture of a surface at distance d moves with
///
///   x: v_x / d - w_y      y: v_y / d + w_x      [rad/s], v and w in body axes
///
/// A sample is this motion over a period in pixels, with normal noise, rounded to a whole number of counts. The
/// rounding error is added to the next sample. A sample is invalid if at any time in its period no surface was below
/// the sensor, the surface was too near, or the motion was too fast.
class FlowSensor {
 public:
  struct Sample {
    std::int64_t number = 0;  ///< since time 0; the start has no sample
    std::array<std::int32_t, 2> counts{};
    bool seen = false;
    double period_s = 0.0;  ///< since the sample before
  };

  FlowSensor(const scene::FlowData& data, std::uint64_t seed, std::int64_t start_ns);

  /// Saved states do not contain the seed, so DroneSensors sets it before every step.
  void reseed(std::uint64_t seed) { seed_ = seed; }

  /// Adds the motion of dt. `state` is the body's state during dt, which ends at time_ns. `distance_m` is the distance
  /// to the next surface along -z; infinity if there is no surface.
  void update(std::int64_t time_ns, const RigidState& state, double distance_m, double dt_s);

  const Sample& sample() const { return sample_; }
  const scene::FlowData& data() const { return data_; }

  void visit(state::Visitor& v);

 private:
  scene::FlowData data_;
  std::int64_t period_ns_;
  std::uint64_t seed_;
  Sample sample_;
  std::array<double, 2> moved_pixels_{};  ///< since the last sample, with its rounding error
  double gathered_s_ = 0.0;
  bool hidden_ = false;  ///< since the last sample
};

}  // namespace mebots::world
