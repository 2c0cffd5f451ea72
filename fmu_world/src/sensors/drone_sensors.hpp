// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"
#include "fmu_world/variables.hpp"
#include "mebots/state/visitor.hpp"
#include "scene/scene.hpp"
#include "sensors/barometer.hpp"
#include "sensors/camera_device.hpp"
#include "sensors/contact_sensor.hpp"
#include "sensors/flow_sensor.hpp"
#include "sensors/imu.hpp"
#include "sensors/magnetometer.hpp"
#include "sensors/multiranger.hpp"
#include "sensors/others.hpp"
#include "sensors/range_sensor.hpp"
#include "sensors/ray_caster.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

namespace mebots::world {

struct Views {
  std::shared_ptr<const camera::Scenery> scenery;  ///< with all drones, if there are several
  std::shared_ptr<const RayCaster> rays;
};

/// A drone's motion in an inner step.
struct Motion {
  const RigidState& from;
  const RigidState& to;
  double dt_s;
  std::int64_t end_ns;
  bool touches;                       ///< true if the body touched something
  Eigen::Vector3d contact_force_W_n;  ///< sum of all contact forces
};

/// Owns the sensors of a drone. The noise of a sensor depends only on the seed, the drone's index, the sensor's
/// noise stream and the number of the sample.
class DroneSensors {
 public:
  /// Throws mebots::Error if a parameter is invalid, or if it needs a sensor that the drone's file does not describe.
  DroneSensors(const Views& views, const scene::Drone& drone, const Parameters& shared,
               const DroneParameters& parameters, std::size_t index, std::int64_t start_ns);

  /// Takes the samples at the start.
  void start(const RigidState& state, std::int64_t start_ns, const Others& others);
  /// Reads the seed. If `trigger` has changed, takes a picture.
  void begin_step(std::int32_t trigger, const RigidState& state, std::int64_t start_ns, const Others& others);
  /// Updates all sensors except the camera at the end of an inner step.
  void update(const Motion& motion, const Others& others);
  void write(DroneOutputs& outputs) const;

  const Imu& imu() const { return imu_; }
  const RangeSensor& range() const { return range_; }
  const FlowSensor* flow() const { return flow_ ? &*flow_ : nullptr; }
  const CameraDevice& camera() const { return camera_; }

  void visit(state::Visitor& v);

 private:
  void enable(const Views& views, const scene::Drone& drone, const DroneParameters& parameters);
  /// Updates the sensors that depend on the body's state and not on its motion.
  void measure(const RigidState& state, std::int64_t time_ns, const Others& others);

  const Parameters& shared_;
  std::size_t index_;
  CameraDevice camera_;
  RangeSensor range_;
  Imu imu_;
  std::optional<FlowSensor> flow_;
  std::optional<Multiranger> multiranger_;
  std::optional<Barometer> barometer_;
  std::optional<Magnetometer> magnetometer_;
  std::optional<ContactSensor> contact_;
  double power_w_ = 0.0;  ///< of the enabled sensors
};

}  // namespace mebots::world
