// SPDX-License-Identifier: Apache-2.0
// The drone's missions with its firmware on GAP8's own devices: fmu_gap8_drone in the place of fmu_soc.
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

/// A shipped mission, flown as it is and judged. A decision takes its frame's 20.2 ms and less than one more frame.
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

/// Mistakes about pictures: told before t = 0, with the place, both sizes and what to do.
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
