// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "support/flight_rig.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace mebots::world::test {

/// Couples a world of several drones with their rotors. FlightRig does this for one drone.
class Fleet {
 public:
  /// `offsets_m` contains start.offset of each drone.
  Fleet(const scene::Scene& scene, const RigParameters& common, const std::vector<std::array<double, 3>>& offsets_m,
        std::optional<scene::DownwashNetworks> networks = {})
      : shared(common),
        drones(drones_at(common, offsets_m)),
        rotors(drones.size(), Rotors(scene.drone)),
        world(
            scene, shared, inputs, outputs, setups(scene, drones),
            [this](std::string_view text) { events.emplace_back(text); }, 0, std::move(networks)) {}

  void step(std::int64_t h_ns = 2'000'000) {
    std::vector<std::array<double, 4>> commands;
    for (std::size_t i = 0; i < drones.size(); ++i) {
      drones[i].inputs.rotor_thrust_n = rotors[i].thrust_n;
      for (std::size_t k = 0; k < 4; ++k)
        drones[i].inputs.rotor_torque_n_m[k] = rotors[i].torque_per_thrust_m * rotors[i].thrust_n[k];
      commands.push_back(drones[i].outputs.rotor_command);
    }
    world.step(time_ns, h_ns);
    for (std::size_t i = 0; i < drones.size(); ++i) rotors[i].step(commands[i], static_cast<double>(h_ns) * 1e-9);
    time_ns += h_ns;
  }

  double time_s() const { return static_cast<double>(time_ns) * 1e-9; }

  static std::vector<DroneVariables> drones_at(const RigParameters& common,
                                               const std::vector<std::array<double, 3>>& offsets_m) {
    std::vector<DroneVariables> drones(offsets_m.size());
    for (std::size_t i = 0; i < drones.size(); ++i) {
      drones[i].parameters = static_cast<const DroneParameters&>(common);
      drones[i].parameters.start_offset_m = offsets_m[i];
    }
    return drones;
  }

  static std::vector<DroneSetup> setups(const scene::Scene& scene, std::vector<DroneVariables>& drones) {
    std::vector<DroneSetup> result;
    for (std::size_t i = 0; i < drones.size(); ++i) {
      result.push_back(
          {fmt::format("drone[{}]", i + 1), scene.drone, drones[i].parameters, drones[i].inputs, drones[i].outputs});
    }
    return result;
  }

  Parameters shared;
  Inputs inputs;
  Outputs outputs;
  std::vector<DroneVariables> drones;
  std::vector<Rotors> rotors;
  std::vector<std::string> events;
  World world;
  std::int64_t time_ns = 0;
};

}  // namespace mebots::world::test
