// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/save.hpp"
#include "model.hpp"
#include "scene/load.hpp"
#include "stabiliser/stabiliser.hpp"

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace mebots::world::test {

inline scene::Drone shipped_drone(const std::string& name) {
  return scene::load_drone(std::string(MEBOTS_SOURCE_DIR) + "/fmu_world/params/drones/" + name + ".json");
}

/// Returns a shipped scene with a drone whose thrust is not limited while the motors start. Transients are then only
/// those of the control loops.
inline scene::Scene shipped_scene(const std::string& name) {
  auto scene = scene::load_scene(std::string(MEBOTS_SOURCE_DIR) + "/fmu_world/params/scenes/" + name + ".json");
  scene.drone = shipped_drone("crazyflie_bench");
  return scene;
}

inline RangeSensor sensor_in(const scene::Scene& scene, const RangeSensor::Settings& settings, std::uint64_t seed) {
  return {std::make_shared<const RayCaster>(scene), scene.drone, settings, seed};
}

/// Four rotors that follow their commands with a first-order lag, which is solved exactly over a step. Their thrust is
/// that of the stabiliser's curve times `sag`. A `sag` below 1 represents a lower bus voltage.
struct Rotors {
  explicit Rotors(const scene::Drone& drone)
      : curve(drone.thrust_curve), torque_per_thrust_m(drone.torque_per_thrust_m) {}

  void step(const std::array<double, 4>& command, double h_s) {
    const double share = lag_s > 0.0 ? -std::expm1(-h_s / lag_s) : 1.0;
    for (std::size_t i = 0; i < 4; ++i) thrust_n[i] += share * (sag * curve.thrust_for(command[i]) - thrust_n[i]);
  }

  ThrustCurve curve;
  double torque_per_thrust_m;
  double lag_s = 0.1;
  double sag = 1.0;
  std::array<double, 4> thrust_n{};
};

struct RigParameters : Parameters, DroneParameters {};
struct RigInputs : Inputs, DroneInputs {};
struct RigOutputs : Outputs, DroneOutputs {};

/// Couples world and rotors as a Jacobi master does. Both step from t_k with the other's outputs at t_k.
class FlightRig {
 public:
  explicit FlightRig(const scene::Scene& scene = shipped_scene("empty"), RigParameters parameters = small_camera(),
                     std::int64_t start_ns = 0)
      : rotors(scene.drone),
        parameters_(std::move(parameters)),
        world(
            scene, parameters_, inputs, outputs, {{"", scene.drone, parameters_, inputs, outputs}},
            [this](std::string_view text) { events.emplace_back(text); }, start_ns),
        time_ns(start_ns) {}

  static RigParameters small_camera() {
    RigParameters parameters;
    parameters.camera_width = 16;  // these flights do not use pictures
    parameters.camera_height = 16;
    parameters.range_noise_m = 0.0;
    return parameters;
  }

  void step(std::int64_t h_ns = 2'000'000) {
    inputs.rotor_thrust_n = rotors.thrust_n;
    for (std::size_t i = 0; i < 4; ++i) inputs.rotor_torque_n_m[i] = rotors.torque_per_thrust_m * rotors.thrust_n[i];
    const auto command = outputs.rotor_command;
    world.step(time_ns, h_ns);
    rotors.step(command, static_cast<double>(h_ns) * 1e-9);
    time_ns += h_ns;
  }

  /// Calls `watch()` after every step.
  template <typename Watch>
  void run(double seconds, Watch watch, std::int64_t h_ns = 2'000'000) {
    const std::int64_t count = std::llround(seconds * 1e9) / h_ns;
    for (std::int64_t i = 0; i < count; ++i) {
      step(h_ns);
      watch();
    }
  }
  void run(double seconds, std::int64_t h_ns = 2'000'000) {
    run(
        seconds, [] {}, h_ns);
  }

  void take_off_and_fly(double altitude_m = 1.0, std::int64_t h_ns = 2'000'000) {
    inputs.setpoint_mode = FlightMode::take_off;
    inputs.setpoint_altitude_m = altitude_m;
    run(8.0, h_ns);
    inputs.setpoint_mode = FlightMode::fly;
  }

  /// Continues from the state of a rig with the same scene and parameters.
  void continue_from(const FlightRig& other) {
    inputs = other.inputs;
    outputs = other.outputs;
    rotors = other.rotors;
    time_ns = other.time_ns;
    state::restore(world, state::save(other.world));
  }

  double time_s() const { return static_cast<double>(time_ns) * 1e-9; }
  double altitude_m() const { return outputs.drone_position_m[2]; }

  RigInputs inputs;
  RigOutputs outputs;
  std::vector<std::string> events;
  Rotors rotors;

 private:
  RigParameters parameters_;

 public:
  World world;
  std::int64_t time_ns;
};

}  // namespace mebots::world::test
