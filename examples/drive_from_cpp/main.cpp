// SPDX-License-Identifier: Apache-2.0
// Runs the easy gate mission from C++, switches a lamp on during the flight, and prints its energy.
#include <mebots/run.hpp>

#include <algorithm>
#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: drive_from_cpp CONFIG.json\n");
    return 2;
  }
  try {
    mebots::Mission mission(argv[1]);
    mission.set("soc.core.clock", 150e6);  // [Hz], replaces the value in the config
    mission.record({"battery.cell.voltage"});
    mission.run_until(2.0);
    mission.write("battery.auxiliary.power", 0.5);  // power of a lamp [W]
    mission.run();

    const auto voltage = mission.series("battery.cell.voltage");
    std::printf("outcome: %s after %.3f s (%s)\n", mission.outcome().c_str(), mission.time_s(),
                mission.end_text().c_str());
    std::printf("lowest cell voltage: %.3f %s, the lamp took %.3f J\n",
                *std::min_element(voltage.values.begin(), voltage.values.end()), voltage.unit.c_str(),
                mission.value("battery.auxiliary.energy"));
    return mission.outcome() == "passed" ? 0 : 1;
  } catch (const mebots::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
