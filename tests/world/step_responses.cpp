// SPDX-License-Identifier: Apache-2.0
#include "support/flight_rig.hpp"

#include <fmt/format.h>
#include <cstdio>
#include <fstream>
#include <functional>

/// Writes one CSV file per manoeuvre and rotor lag. fmu_world/docs/plot_step_responses.py plots the files.
namespace {

using mebots::world::FlightMode;
using mebots::world::test::FlightRig;
using mebots::world::test::RigInputs;

struct Manoeuvre {
  const char* name;
  double seconds;
  std::function<void(RigInputs&)> begin;
};

void write(const std::string& folder, const Manoeuvre& manoeuvre, double lag_s) {
  FlightRig rig;
  rig.rotors.lag_s = lag_s;
  rig.rotors.sag = 0.95;
  if (manoeuvre.begin) rig.take_off_and_fly();
  std::ofstream csv(fmt::format("{}/{}_{:.0f}ms.csv", folder, manoeuvre.name, 1e3 * lag_s));
  csv << "time,vx,vy,yaw_rate,altitude,tilt,command\n";
  const double start_s = rig.time_s();
  if (manoeuvre.begin) {
    manoeuvre.begin(rig.inputs);
  } else {
    rig.inputs.setpoint_mode = FlightMode::take_off;
  }
  rig.run(manoeuvre.seconds, [&] {
    const auto& out = rig.outputs;
    csv << fmt::format("{},{},{},{},{},{},{}\n", rig.time_s() - start_s, out.drone_velocity_m_per_s[0],
                       out.drone_velocity_m_per_s[1], out.drone_angular_velocity_rad_per_s[2], rig.altitude_m(),
                       std::hypot(out.drone_roll_rad, out.drone_pitch_rad), out.rotor_command[0]);
  });
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: world_step_responses FOLDER\n", stderr);
    return 2;
  }
  const Manoeuvre manoeuvres[] = {
      {"take_off", 8.0, {}},
      {"velocity", 6.0, [](RigInputs& in) { in.setpoint_velocity_x_m_per_s = 1.0 / 3.6; }},
      {"yaw_rate", 3.0, [](RigInputs& in) { in.setpoint_yaw_rate_rad_per_s = 0.5; }},
      {"altitude", 6.0, [](RigInputs& in) { in.setpoint_altitude_m = 1.3; }},
      {"wind", 10.0,
       [](RigInputs& in) {
         in.wind_velocity_m_per_s = {0.0, 2.0, 0.0};
       }},
  };
  for (const auto& manoeuvre : manoeuvres) {
    for (const double lag_s : {0.05, 0.1, 0.15}) write(argv[1], manoeuvre, lag_s);
  }
  return 0;
}
