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

/// Takes a picture when the count of requests changes. Two buffers keep a picture's bytes valid while the next picture
/// is taken, so a reader may use them until the end of the next step.
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

  /// Sets the seed for the noise of later pictures. Saved states do not contain the seed, so DroneSensors sets it
  /// before every step.
  void reseed(std::uint64_t seed) { settings_.seed = seed; }

  /// If `count` differs from the last count and is not 0, takes a picture from the body's pose at time_ns. `others` are
  /// the drones and robots that the picture may show.
  void see_trigger(std::int32_t count, const RigidState& body, std::int64_t time_ns, const Others& others = {});

  const Settings& settings() const { return settings_; }
  /// Returns the last picture, row by row from the top left; empty before the first picture.
  std::span<const std::uint8_t> frame() const;
  /// Returns the depth picture of the last picture, in the format of GroundTruth::depth(). Empty if `depth` is false,
  /// and before the first picture.
  std::span<const std::uint8_t> depth() const;
  /// Returns the gates and drones in the last picture as JSON (docs/sensors.md describes the format). Empty if `labels`
  /// is false.
  std::string objects_text() const;
  /// Returns the trigger count with which the last picture was taken; 0 before the first picture.
  std::int32_t frame_id() const { return frame_id_; }
  /// Returns the exposure of the last picture; 0 before the first picture. gain() works in the same way.
  double exposure_s() const { return exposure_s_; }
  double gain() const { return gain_; }

  void visit(state::Visitor& v);

 private:
  struct Pictured {
    RigidState body;
    std::vector<RigidState> others;
    std::uint64_t own = 0;
    std::int64_t time_ns = 0;

    void visit(state::Visitor& v);
  };

  /// Returns the camera's pose `after_s` seconds after the start of the last picture. Assumes that all bodies continue
  /// their motion.
  camera::Pose pose_after(double after_s) const;

  Settings settings_;
  /// Exactly one of these two has a value: the renderer if the settings of lens and sensor have no effect, otherwise
  /// the sensor.
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
