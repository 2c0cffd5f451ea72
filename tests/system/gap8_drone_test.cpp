// SPDX-License-Identifier: Apache-2.0
// Tests missions with the drone's firmware on GAP8's own devices: with fmu_gap8_drone in place of fmu_soc.
#include "missions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace mebots::system_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::filesystem::path shipped(const std::string& name) {
  return std::filesystem::path(MEBOTS_SOURCE_DIR) / "configs" / (name + ".json");
}

/// Runs an unchanged shipped mission and checks its result. A decision takes at least 20.2 ms, the read-out time of the
/// camera's frame.
void expect_passed(const std::string& mission, int least_pictures) {
  const Folder folder;
  const auto flight = fly(shipped(mission), folder / "out");
  ASSERT_EQ(flight.exit_code, 0) << flight.output;
  EXPECT_EQ(flight.summary.at("outcome"), "passed");
  EXPECT_GE(flight.summary.at("pictures").get<int>(), least_pictures);
  EXPECT_LT(std::abs(flight.summary.at("lateral_error").get<double>()), 0.05);
  const auto& mean = flight.summary.at("decision").at("mean");
  EXPECT_LT(mean.at("request").get<double>(), 0.001) << "the sensor waits for the request, not the other way round";
  EXPECT_NEAR(mean.at("read_out").get<double>(), 322 * 376 / 6e6, 1e-6) << "rows up to the window's last one";
  EXPECT_LT(mean.at("latency").get<double>(), 0.030);
}

TEST(Gap8Drone, FliesTheEasyMissionByTheNavigator) {
  expect_passed("gate_easy_gap8", 150);
}

TEST(Gap8Drone, FliesTheHardMissionBySight) {
  expect_passed("gate_hard_gap8", 600);
}

/// By default, the cluster has 87 MHz at 1.2 V. An inference then takes 3.1 ms.
TEST(Gap8Drone, TheFirmwareSetsTheClocksAndTheVoltageThatTheMissionSays) {
  const Folder folder;
  const std::vector<std::string> short_flight{"--stop-time", "6"};
  const auto usual = fly(shipped("gate_easy_gap8"), folder / "usual", {}, short_flight);
  const auto slow = fly(shipped("gate_easy_gap8"), folder / "slow",
                        {"soc.cluster.clock=25e6", "soc.core.clock=50e6", "soc.core.supply_voltage=1.0"}, short_flight);
  ASSERT_EQ(usual.exit_code, 0) << usual.output;
  ASSERT_EQ(slow.exit_code, 0) << slow.output;
  const auto inference_s = [](const auto& flight) {
    return flight.summary.at("decision").at("mean").at("inference").template get<double>();
  };
  const auto chip_j = [](const auto& flight) {
    return flight.summary.at("chip_energy").at("total").template get<double>();
  };
  // The time of an inference is almost inversely proportional to the cluster's clock. It is not exactly proportional,
  // because an access to L2 takes fewer cycles of a slower clock.
  EXPECT_NEAR(inference_s(slow) / inference_s(usual), 87.0 / 25.0, 0.25);
  EXPECT_LT(chip_j(slow), 0.8 * chip_j(usual)) << "the voltage goes in squared";
}

/// Checks that the error about the pictures' size occurs before t = 0, with the place, both sizes and the remedy.
TEST(Gap8Drone, PicturesOfAnotherSizeThanTheSensorsAreRefusedBeforeTheFlight) {
  const Folder folder;
  const auto flight =
      fly(shipped("gate_easy_gap8"), folder / "out", {"world.camera.width=648", "world.camera.height=162"});
  EXPECT_EQ(flight.exit_code, 2);
  EXPECT_THAT(flight.output, AllOf(HasSubstr("/connections/6"),
                                   HasSubstr("world.camera.width is 648 and soc.camera.frame_width is 324")))
      << "648 x 162 has as many bytes as 324 x 324";
}

TEST(Gap8Drone, RecordedPicturesOfAnotherWidthAreRefusedBeforeTheFlight) {
  auto config = shipped_config("gate_easy");
  config["pictures"][0]["width"] = 160;
  const Folder folder;
  const auto flight = fly(write(folder / "mission.json", config), folder / "out");
  EXPECT_EQ(flight.exit_code, 2);
  EXPECT_THAT(flight.output, HasSubstr("/pictures/0/width: 160, but world.camera.width is 320"));
}

}  // namespace
}  // namespace mebots::system_test
