// SPDX-License-Identifier: Apache-2.0
// Measures speed and memory of a world with several drones. The speed is the number of drones times simulated time,
// divided by wall-clock time. The drones hover with the Crazyflie's own cascade. Each rotor is a first-order lag. There
// are no pictures, chips or master.
#include "model.hpp"
#include "scene/load.hpp"
#include "stabiliser/stabiliser.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

namespace {

using namespace mebots::world;  // NOLINT(google-build-using-namespace): a program of one subject

constexpr std::int64_t kStep_ns = 2'000'000;
constexpr double kRotorLag_s = 0.1;

double resident_mib() {
  std::ifstream file("/proc/self/statm");
  long size = 0;
  long resident = 0;
  file >> size >> resident;
  return static_cast<double>(resident * sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

double processor_s() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

class Fleet {
 public:
  Fleet(const scene::Scene& scene, std::size_t count)
      : curve_(scene.drone.thrust_curve), torque_per_thrust_m_(scene.drone.torque_per_thrust_m), drones_(count) {
    shared_.start_spacing_m = {0.0, 0.5, 0.0};
    std::vector<DroneSetup> setups;
    for (std::size_t i = 0; i < count; ++i) {
      DroneVariables& own = drones_[i];
      own.parameters.stabiliser_controller = FlightController::crazyflie;
      own.inputs.setpoint_mode = FlightMode::take_off;
      setups.push_back({fmt::format("drone[{}]", i + 1), scene.drone, own.parameters, own.inputs, own.outputs});
    }
    world_ = std::make_unique<World>(scene, shared_, inputs_, outputs_, std::move(setups), nullptr, 0);
  }

  void step() {
    const double share = -std::expm1(-1e-9 * kStep_ns / kRotorLag_s);
    for (auto& drone : drones_) {
      for (std::size_t k = 0; k < 4; ++k) {
        double& thrust_n = drone.inputs.rotor_thrust_n[k];
        thrust_n += share * (curve_.thrust_for(drone.outputs.rotor_command[k]) - thrust_n);
        drone.inputs.rotor_torque_n_m[k] = torque_per_thrust_m_ * thrust_n;
      }
    }
    world_->step(time_ns_, kStep_ns);
    time_ns_ += kStep_ns;
  }

  bool all_fly() const {
    for (const auto& drone : drones_) {
      if (drone.outputs.drone_position_m[2] < 0.5 || drone.outputs.drone_crashed) return false;
    }
    return true;
  }

 private:
  ThrustCurve curve_;
  double torque_per_thrust_m_;
  Parameters shared_;
  Inputs inputs_;
  Outputs outputs_;
  std::vector<DroneVariables> drones_;
  std::unique_ptr<World> world_;
  std::int64_t time_ns_ = 0;
};

void measure(const scene::Scene& scene, std::size_t count, double seconds) {
  const double before_mib = resident_mib();
  Fleet fleet(scene, count);
  const double memory_mib = resident_mib() - before_mib;
  for (int i = 0; i < 4000; ++i) fleet.step();
  const bool all_fly = fleet.all_fly();
  const double begin_s = processor_s();
  const auto steps = std::llround(seconds * 1e9) / kStep_ns;
  for (std::int64_t i = 0; i < steps; ++i) fleet.step();
  const double spent_s = processor_s() - begin_s;
  fmt::print("{:6} {:14.1f} {:22.1f} {:20.2f} {:12.1f}{}\n", count, seconds / spent_s,
             static_cast<double>(count) * seconds / spent_s,
             1e6 * spent_s / static_cast<double>(steps) / static_cast<double>(count), memory_mib,
             all_fly ? "" : "   not all drones fly");
}

}  // namespace

int main(int argc, char** argv) {
  const auto scene = scene::load_scene(std::string(MEBOTS_SOURCE_DIR) + "/fmu_world/params/scenes/empty.json");
  const double seconds = argc > 1 ? std::strtod(argv[1], nullptr) : 20.0;
  fmt::print("drones  x real time   drones x real time   us per drone, step   MiB\n");
  for (const std::size_t count : {1U, 5U, 16U, 64U}) measure(scene, count, seconds);
  return 0;
}
