// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/sensor.hpp"
#include "dynamics/airframe.hpp"
#include "mebots/state/visitor.hpp"
#include "scene/scene.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace mebots::world {

/// Takes a picture when the count of requests changes. Two buffers: a picture's bytes stay in place while the
/// next one is taken, so a reader may hold them until the next step ends.
class CameraDevice {
 public:
  struct Settings {
    camera::Intrinsics intrinsics;
    camera::Mounting mounting;
    camera::LensSettings lens;
    camera::SensorSettings sensor;
    std::uint64_t seed = 0;  ///< until reseed()
  };

  CameraDevice(const scene::Scene& scene, const Settings& settings);

  /// Of the noise of pictures from now on. No part of the state: who holds the seed says it before every step.
  void reseed(std::uint64_t seed) { settings_.seed = seed; }

  /// Takes a picture from the body's pose at a time if `count` is new. A count of 0 asks for none.
  void see_trigger(std::int32_t count, const RigidState& body, std::int64_t time_ns);

  /// The last picture, row by row from the top left; empty before the first.
  std::span<const std::uint8_t> frame() const;
  /// The count that the last picture answers; 0 before the first.
  std::int32_t frame_id() const { return frame_id_; }
  /// Of the last picture; 0 before the first.
  double exposure_s() const { return exposure_s_; }
  double gain() const { return gain_; }

  void visit(state::Visitor& v);

 private:
  /// The camera's pose some time after `time_ns`, while the body goes on as it does then.
  camera::Pose pose_after(const RigidState& body, std::int64_t time_ns, double after_s) const;

  Settings settings_;
  /// One of the two: the sensor where a parameter asks for what only it does.
  std::optional<camera::Renderer> renderer_;
  std::optional<camera::Sensor> sensor_;
  std::array<std::vector<std::uint8_t>, 2> buffers_;
  std::uint8_t front_ = 0;
  std::int32_t last_count_ = 0;
  std::int32_t frame_id_ = 0;
  double exposure_s_ = 0.0;
  double gain_ = 0.0;
};

}  // namespace mebots::world
