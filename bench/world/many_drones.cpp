// SPDX-License-Identifier: Apache-2.0
// Measures speed and memory of a world with several drones. The speed is the number of drones times simulated time,
// divided by processor time. The drones hover with the Crazyflie's own cascade. Each rotor is a first-order lag. There
// are no pictures, chips or master. Then measures the times of a picture and of the output camera.objects, for a drone
// whose camera sees all others.
#include "model.hpp"
#include "scene/load.hpp"
#include "stabiliser/stabiliser.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
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

/// Returns the median of the processor times of 60 calls [ms].
template <typename Act>
double median_ms(const Act& act) {
  std::vector<double> times_ms(60);
  for (double& time_ms : times_ms) {
    const double begin_s = processor_s();
    act();
    time_ms = 1e3 * (processor_s() - begin_s);
  }
  std::nth_element(times_ms.begin(), times_ms.begin() + 30, times_ms.end());
  return times_ms[30];
}

/// Measures pictures and camera.objects. The camera of the first drone sees all others, which are 1.5 to 2.7 m ahead of
/// it in rows of five.
void measure_objects(const scene::Scene& scene, std::size_t count) {
  Parameters shared;
  shared.start_spacing_m = {};
  Inputs inputs;
  Outputs outputs;
  std::vector<DroneVariables> drones(count);
  std::vector<DroneSetup> setups;
  for (std::size_t i = 0; i < count; ++i) {
    DroneVariables& own = drones[i];
    own.parameters.camera_labels = true;
    if (i > 0) {
      const auto place = static_cast<int>(i) - 1;
      own.parameters.start_offset_m = {1.5 + 0.6 * (place / 5), 0.3 * (place % 5 - 2), 0.2 * (place / 5)};
    }
    own.parameters.start_offset_m[2] += 1.0;
    setups.push_back({fmt::format("drone[{}]", i + 1), scene.drone, own.parameters, own.inputs, own.outputs});
  }
  World world(scene, shared, inputs, outputs, std::move(setups), nullptr, 0);
  std::int64_t time_ns = 0;
  const auto take_pictures = [&](std::size_t cameras) {
    for (std::size_t i = 0; i < cameras; ++i) ++drones[i].inputs.camera_trigger;
    world.step(time_ns, 1000);  // short, so that the drones hardly fall
    time_ns += 1000;
  };
  const double step_ms = median_ms([&] { take_pictures(0); });
  const double picture_ms = median_ms([&] { take_pictures(1); }) - step_ms;
  std::string text;
  const double objects_ms = median_ms([&] { text = world.camera(0)->objects_text(); });
  take_pictures(count);
  const double all_ms = median_ms([&] {
    for (std::size_t i = 0; i < count; ++i) text = world.camera(i)->objects_text();
  });
  const std::string shown = world.camera(0)->objects_text();
  std::size_t boxes = 0;
  for (std::size_t at = shown.find("class"); at != std::string::npos; at = shown.find("class", at + 1)) ++boxes;
  fmt::print("{:6} {:20} {:18.2f} {:22.2f} {:26.2f}\n", count, boxes, picture_ms, objects_ms, all_ms);
}

}  // namespace

int main(int argc, char** argv) {
  const auto scene = scene::load_scene(std::string(MEBOTS_SOURCE_DIR) + "/fmu_world/params/scenes/empty.json");
  const double seconds = argc > 1 ? std::strtod(argv[1], nullptr) : 20.0;
  fmt::print("drones  x real time   drones x real time   us per drone, step   MiB\n");
  for (const std::size_t count : {1U, 5U, 16U, 64U}) measure(scene, count, seconds);
  fmt::print("\ndrones   objects in picture   ms per picture   ms per camera.objects   ms for those of all drones\n");
  for (const std::size_t count : {1U, 4U, 16U}) measure_objects(scene, count);
  return 0;
}
