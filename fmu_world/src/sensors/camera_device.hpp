// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/sensor.hpp"
#include "dynamics/airframe.hpp"
#include "mebots/state/visitor.hpp"
#include "scene/scene.hpp"
#include "sensors/others.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace mebots::world {

/// Takes a picture when the count of requests changes. It has two buffers. So a picture's bytes stay valid while the
/// next picture is taken, and a reader may use them until the end of the next step.
class CameraDevice {
 public:
  struct Settings {
    camera::Intrinsics intrinsics;
    camera::Mounting mounting;
    camera::LensSettings lens;
    camera::SensorSettings sensor;
    std::uint64_t seed = 0;  ///< until reseed()
  };

  CameraDevice(const std::shared_ptr<const camera::Scenery>& scenery, const Settings& settings);

  /// Sets the seed for the noise of later pictures. The seed is not part of the state: its owner sets it before every
  /// step.
  void reseed(std::uint64_t seed) { settings_.seed = seed; }

  /// Takes a picture from the body's pose at a time if `count` is new. A count of 0 requests no picture. `others` are
  /// the drones in the picture.
  void see_trigger(std::int32_t count, const RigidState& body, std::int64_t time_ns, const Others& others = {});

  const Settings& settings() const { return settings_; }
  /// Returns the last picture, row by row from the top left; empty before the first.
  std::span<const std::uint8_t> frame() const;
  /// Returns the count of the last picture; 0 before the first.
  std::int32_t frame_id() const { return frame_id_; }
  /// Return exposure and gain of the last picture; 0 before the first.
  double exposure_s() const { return exposure_s_; }
  double gain() const { return gain_; }

  void visit(state::Visitor& v);

 private:
  /// Returns the camera's pose `after_s` after `time_ns` if the body continues its present motion.
  camera::Pose pose_after(const RigidState& body, std::int64_t time_ns, double after_s, const Others& others);

  Settings settings_;
  /// Either the renderer or the sensor is set. The sensor is set if a parameter needs it.
  std::optional<camera::Renderer> renderer_;
  std::optional<camera::Sensor> sensor_;
  std::array<std::vector<std::uint8_t>, 2> buffers_;
  std::vector<camera::BodyPose> bodies_;  // of the present picture
  std::uint8_t front_ = 0;
  std::int32_t last_count_ = 0;
  std::int32_t frame_id_ = 0;
  double exposure_s_ = 0.0;
  double gain_ = 0.0;
};

}  // namespace mebots::world
