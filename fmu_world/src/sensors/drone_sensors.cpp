// SPDX-License-Identifier: Apache-2.0
#include "sensors/drone_sensors.hpp"

#include "math/arrays.hpp"
#include "math/checks.hpp"
#include "mebots/error.hpp"
#include "noise/counter_noise.hpp"

#include <fmt/format.h>
#include <string_view>

namespace mebots::world {
namespace {

/// The first drone uses the seed unchanged, as in a world with one drone.
std::uint64_t seed_of(const Parameters& shared, std::size_t index) {
  const std::uint64_t seed = static_cast<std::uint32_t>(shared.sensors_seed);
  return index == 0 ? seed : noise::bits(seed, noise::Stream::drone, index);
}

CameraDevice::Settings camera_settings(const DroneParameters& parameters, std::uint64_t seed) {
  CameraDevice::Settings settings;
  settings.intrinsics.width = parameters.camera_width;
  settings.intrinsics.height = parameters.camera_height;
  settings.intrinsics.horizontal_field_of_view_rad = parameters.camera_field_of_view_rad;
  settings.mounting.p_BC_m = to_vector(parameters.camera_position_m);
  settings.mounting.pitch_rad = parameters.camera_pitch_rad;
  settings.lens = {parameters.camera_distortion_k1, parameters.camera_distortion_k2, parameters.camera_vignetting};
  settings.sensor = {
      .exposure_s = parameters.camera_exposure_s,
      .reference_exposure_s = parameters.camera_reference_exposure_s,
      .gain = parameters.camera_gain,
      .automatic = parameters.camera_auto_exposure,
      .target = parameters.camera_auto_exposure_target,
      .most_exposure_s = parameters.camera_auto_exposure_longest_s,
      .most_gain = parameters.camera_auto_gain_most,
      .line_time_s = parameters.camera_line_time_s,
      .blur_samples = parameters.camera_blur_samples,
      .full_well = parameters.camera_full_well,
      .noise_std = parameters.camera_noise,
  };
  settings.labels = parameters.camera_labels;
  settings.depth = parameters.camera_depth_enabled;
  settings.depth_noise_per_m = parameters.camera_depth_noise_per_m;
  settings.seed = seed;
  return settings;
}

/// Returns the data of a sensor. If the drone's file lacks them, throws mebots::Error. The message names `needs`, which
/// is the parameter that requires the data, and `section`, which is the missing section of the file.
template <typename Data>
const Data& described(const std::optional<Data>& data, const scene::Drone& drone, std::string_view needs,
                      std::string_view section) {
  if (data) return *data;
  throw Error(fmt::format("{} needs {} in the drone file of \"{}\"; add it or leave the parameter out", needs, section,
                          drone.name));
}

std::optional<FlowSensor> flow_sensor(const scene::Drone& drone, const DroneParameters& parameters, std::uint64_t seed,
                                      std::int64_t start_ns) {
  if (!parameters.flow_enabled && parameters.stabiliser_state == StateSource::truth) return std::nullopt;
  const std::string_view needs = parameters.flow_enabled ? "flow.enabled" : "stabiliser.state = estimate";
  return FlowSensor(described(drone.flow, drone, needs, "flow_sensor"), seed, start_ns);
}

Ranging::Settings ranging_settings(const DroneParameters& parameters) {
  require_at_least_zero(parameters.range_noise_m, "range.noise");
  if (to_string(parameters.range_model) == "?") {
    throw Error(fmt::format("range.model = {} is not a model; ray is 0, cone 1",
                            static_cast<std::int32_t>(parameters.range_model)));
  }
  return {parameters.range_model, parameters.range_noise_m};
}

Imu::Settings imu_settings(const DroneParameters& parameters) {
  return {parameters.imu_acceleration_noise_m_per_s2, parameters.imu_acceleration_bias_m_per_s2,
          parameters.imu_rate_noise_rad_per_s, parameters.imu_rate_bias_rad_per_s};
}

Air air_of(const Parameters& shared) {
  return {checked(shared.air_pressure_pa, 0.0, 1e7, "air.pressure"),
          checked(shared.air_temperature_k, 1.0, 1e4, "air.temperature")};
}

Eigen::Vector3d magnetic_field_of(const Parameters& shared) {
  for (std::size_t i = 0; i < axis::kCount; ++i)
    require_finite(shared.magnetic_field_t[i], "magnetic.field.", axis::kWords[i]);
  return to_vector(shared.magnetic_field_t);
}

}  // namespace

DroneSensors::DroneSensors(const Views& views, const scene::Drone& drone, const Parameters& shared,
                           const DroneParameters& parameters, std::size_t index, std::int64_t start_ns)
    : shared_(shared),
      index_(index),
      camera_(views.scenery, camera_settings(parameters, seed_of(shared, index))),
      range_(views.rays, drone, ranging_settings(parameters), seed_of(shared, index)),
      imu_(imu_settings(parameters), seed_of(shared, index)),
      flow_(flow_sensor(drone, parameters, seed_of(shared, index), start_ns)) {
  enable(views, drone, parameters);
}

void DroneSensors::enable(const Views& views, const scene::Drone& drone, const DroneParameters& parameters) {
  const std::uint64_t seed = seed_of(shared_, index_);
  if (parameters.multiranger_enabled) {
    const auto& data = described(drone.multiranger, drone, "multiranger.enabled", "multiranger");
    multiranger_.emplace(views.rays, drone, data, ranging_settings(parameters), seed);
    power_w_ += data.power_w;
  }
  if (parameters.barometer_enabled) {
    const auto& data = described(drone.barometer, drone, "barometer.enabled", "barometer");
    barometer_.emplace(data, air_of(shared_), seed);
    power_w_ += data.power_w;
  }
  if (parameters.magnetometer_enabled) {
    const auto& data = described(drone.magnetometer, drone, "magnetometer.enabled", "magnetometer");
    magnetometer_.emplace(data, magnetic_field_of(shared_), seed);
    power_w_ += data.power_w;
  }
  if (parameters.contact_enabled) {
    require_at_least_zero(parameters.contact_noise_n, "contact.noise");
    contact_.emplace(checked(parameters.contact_period_s, 0.001, 10.0, "contact.period"), parameters.contact_noise_n,
                     seed);
  }
}

void DroneSensors::start(const RigidState& state, std::int64_t start_ns, const Others& others) {
  range_.update(start_ns, state, others);
  measure(state, start_ns, others);
}

void DroneSensors::measure(const RigidState& state, std::int64_t time_ns, const Others& others) {
  if (multiranger_) multiranger_->update(time_ns, state, others);
  if (barometer_) barometer_->update(time_ns, state.p_WB_m.z());
  if (magnetometer_) magnetometer_->update(time_ns, state.q_WB);
}

void DroneSensors::begin_step(std::int32_t trigger, const RigidState& state, std::int64_t start_ns,
                              const Others& others) {
  // The seed is a tunable parameter, so it may have changed since the last step.
  const auto seed = seed_of(shared_, index_);
  camera_.reseed(seed);
  range_.reseed(seed);
  imu_.reseed(seed);
  if (flow_) flow_->reseed(seed);
  if (multiranger_) multiranger_->reseed(seed);
  if (barometer_) barometer_->reseed(seed);
  if (magnetometer_) magnetometer_->reseed(seed);
  if (contact_) contact_->reseed(seed);
  camera_.see_trigger(trigger, state, start_ns, others);
}

void DroneSensors::update(const Motion& motion, const Others& others) {
  const auto& [from, to, dt_s, end_ns, touches, contact_force_W_n] = motion;
  range_.update(end_ns, to, others);
  imu_.update(end_ns, from, to, dt_s);
  if (flow_) flow_->update(end_ns, to, range_.sight_m(to, end_ns, others), dt_s);
  measure(to, end_ns, others);
  if (contact_) contact_->update(end_ns, touches, to.q_WB.conjugate() * contact_force_W_n, dt_s);
}

void DroneSensors::write(DroneOutputs& outputs) const {
  outputs.imu_acceleration_m_per_s2 = to_array(imu_.acceleration_m_per_s2());
  outputs.imu_angular_velocity_rad_per_s = to_array(imu_.rate_rad_per_s());
  outputs.range_down_m = range_.reading_m();
  outputs.camera_frame = fmu::BinaryRef::to(camera_.frame());
  outputs.camera_depth = fmu::BinaryRef::to(camera_.depth());
  outputs.camera_frame_id = camera_.frame_id();
  outputs.camera_frame_exposure_s = camera_.exposure_s();
  outputs.camera_frame_gain = camera_.gain();
  outputs.sensors_power_w = power_w_;
  if (multiranger_) outputs.multiranger_m = multiranger_->readings_m();
  if (barometer_) outputs.barometer_pressure_pa = barometer_->pressure_pa();
  if (magnetometer_) outputs.magnetometer_field_t = to_array(magnetometer_->field_B_t());
  if (contact_) {
    outputs.contact_touching = contact_->touching();
    outputs.contact_force_n = to_array(contact_->force_B_n());
  }
  if (!flow_) return;
  outputs.flow_motion_x = flow_->sample().counts[0];
  outputs.flow_motion_y = flow_->sample().counts[1];
  outputs.flow_seen = flow_->sample().seen;
}

void DroneSensors::visit(state::Visitor& v) {
  v("camera", camera_);
  v("range", range_);
  v("imu", imu_);
  if (flow_) v("flow", *flow_);
  if (multiranger_) v("multiranger", *multiranger_);
  if (barometer_) v("barometer", *barometer_);
  if (magnetometer_) v("magnetometer", *magnetometer_);
  if (contact_) v("contact_sensor", *contact_);
}

}  // namespace mebots::world
