// SPDX-License-Identifier: Apache-2.0
// The drone's missions with its firmware on GAP8's own devices: fmu_gap8_drone in the place of fmu_soc.
#include "missions.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace mebots::system_test {
namespace {

constexpr double kEasyLens = 1.51844;  // rad, of 320 pixels: the world's default
constexpr double kHardLens = 0.87;

/// A shipped mission, flown and judged. The sensor sends 324 x 324 pixels, of which the firmware takes 320 in the
/// middle: they see what the lens says.
void expect_passed(const std::string& mission, const char* firmware, double lens, int least_pictures) {
  auto config = shipped_config(mission);
  auto& soc = config["instances"]["soc"];
  soc["fmu"] = "fmu_gap8_drone";
  soc["parameters"]["firmware"] = firmware;
  auto& world = config["instances"]["world"]["parameters"];
  world["camera.width"] = 324;
  world["camera.height"] = 324;
  config["pictures"][0]["width"] = 324;
  world["camera.field_of_view"] = 2 * std::atan(std::tan(lens / 2) * 324 / 320);

  const Folder folder;
  const auto flight = fly(write(folder / (mission + ".json"), config), folder / "out");
  ASSERT_EQ(flight.exit_code, 0) << flight.output;
  EXPECT_EQ(flight.summary.at("outcome"), "passed");
  EXPECT_GE(flight.summary.at("pictures").get<int>(), least_pictures);
  EXPECT_LT(std::abs(flight.summary.at("lateral_error").get<double>()), 0.05);
}

TEST(Gap8Drone, FliesTheEasyMissionByTheNavigator) {
  expect_passed("gate_easy", "gap8_gate", kEasyLens, 150);
}

TEST(Gap8Drone, FliesTheHardMissionBySight) {
  expect_passed("gate_hard", "gap8_sight", kHardLens, 400);
}

}  // namespace
}  // namespace mebots::system_test
