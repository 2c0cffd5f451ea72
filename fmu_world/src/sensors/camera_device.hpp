// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/ground_truth.hpp"
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
#include <string>
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
    bool labels = false;             ///< objects_text() has the objects of pictures
    bool depth = false;              ///< each picture has a depth picture
    double depth_noise_per_m = 0.0;  ///< standard deviation of a depth over its square
    std::uint64_t seed = 0;          ///< until reseed()
  };

  CameraDevice(const std::shared_ptr<const camera::Scenery>& scenery, const Settings& settings);

  /// Sets the seed for the noise of later pictures. Saved states do not contain it, so DroneSensors sets it before
  /// every step.
  void reseed(std::uint64_t seed) { settings_.seed = seed; }

  /// Takes a picture from the body's pose at a time if `count` is new. A count of 0 requests no picture. `others` are
  /// the drones in the picture.
  void see_trigger(std::int32_t count, const RigidState& body, std::int64_t time_ns, const Others& others = {});

  const Settings& settings() const { return settings_; }
  /// Returns the last picture, row by row from the top left; empty before the first.
  std::span<const std::uint8_t> frame() const;
  /// Returns the depth picture of the last picture, as GroundTruth::depth() writes it; empty without one.
  std::span<const std::uint8_t> depth() const;
  /// Returns gates and drones in the last picture as JSON; empty without `labels`. docs/sensors.md has the format.
  std::string objects_text() const;
  /// Returns the count of the last picture; 0 before the first.
  std::int32_t frame_id() const { return frame_id_; }
  /// Return exposure and gain of the last picture; 0 before the first.
  double exposure_s() const { return exposure_s_; }
  double gain() const { return gain_; }

  void visit(state::Visitor& v);

 private:
  /// The bodies at the start of a picture.
  struct Pictured {
    RigidState body;
    std::vector<RigidState> others;
    std::uint64_t own = 0;
    std::int64_t time_ns = 0;

    void visit(state::Visitor& v);
  };

  /// Returns the camera's pose `after_s` after the start of the last picture if all bodies continue their motion.
  camera::Pose pose_after(double after_s) const;

  Settings settings_;
  /// Either the renderer or the sensor is set. The sensor is set if a parameter needs it.
  std::optional<camera::Renderer> renderer_;
  std::optional<camera::Sensor> sensor_;
  std::array<std::vector<std::uint8_t>, 2> buffers_;
  std::unique_ptr<camera::GroundTruth> truth_;  // null without labels and depth
  std::array<std::vector<std::uint8_t>, 2> depths_;
  Pictured pictured_;                             // of the last picture; part of the state with labels
  mutable std::vector<camera::BodyPose> bodies_;  // memory of pose_after()
  std::uint8_t front_ = 0;
  std::int32_t last_count_ = 0;
  std::int32_t frame_id_ = 0;
  double exposure_s_ = 0.0;
  double gain_ = 0.0;
};

}  // namespace mebots::world
