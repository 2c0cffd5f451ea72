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

/// Parts of the world that the sensors of all drones share.
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

/// Owns the sensors of a drone. The noise of a sensor depends on the seed, the drone's index, the sensor's own stream
/// and the number of the sample only.
class DroneSensors {
 public:
  /// Throws mebots::Error for invalid parameters, and for a sensor that the drone's file does not describe.
  DroneSensors(const Views& views, const scene::Drone& drone, const Parameters& shared,
               const DroneParameters& parameters, std::size_t index, std::int64_t start_ns);

  /// Takes the first samples of the sensors that have one at the start.
  void start(const RigidState& state, std::int64_t start_ns, const Others& others);
  /// Reads the seed, and takes a picture if `trigger` is new.
  void begin_step(std::int32_t trigger, const RigidState& state, std::int64_t start_ns, const Others& others);
  /// Updates all sensors except the camera at the end of an inner step.
  void update(const Motion& motion, const Others& others);
  void write(DroneOutputs& outputs) const;

  const Imu& imu() const { return imu_; }
  const RangeSensor& range() const { return range_; }
  /// Returns null if the drone has no flow sensor.
  const FlowSensor* flow() const { return flow_ ? &*flow_ : nullptr; }
  const CameraDevice& camera() const { return camera_; }

  void visit(state::Visitor& v);

 private:
  /// Creates the sensors that are off by default.
  void enable(const Views& views, const scene::Drone& drone, const DroneParameters& parameters);
  /// Updates the sensors that measure the body's state, without its motion.
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
