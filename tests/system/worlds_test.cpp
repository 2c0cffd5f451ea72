// SPDX-License-Identifier: Apache-2.0
#include "missions.hpp"

#include <gtest/gtest.h>

namespace mebots::system_test {
namespace {

/// Runs the first seconds of a shipped mission: the take-off, and the flight towards the first gate, which the pilot
/// sees in the camera's pictures.
Flight first_seconds(const std::string& name, const Folder& folder, const std::vector<std::string>& sets = {}) {
  auto config = shipped_config(name);
  config["stop_time"] = 9.0;
  return fly(write(folder / (name + ".json"), config), folder / "out", sets);
}

void expect_on_the_way(const Flight& flight) {
  ASSERT_EQ(flight.exit_code, 0) << flight.output;
  EXPECT_EQ(flight.summary.at("outcome"), "timeout") << flight.output;
  EXPECT_EQ(flight.summary.at("crashed"), false);
  EXPECT_GT(flight.summary.at("pictures").get<int>(), 20);
  const auto altitude = column(flight.results, "world.drone.position.z");
  EXPECT_GT(altitude.back(), 0.7);
  EXPECT_LT(altitude.back(), 2.0);  // the pilot climbs if it sees the gate above
  const auto distance = column(flight.results, "world.gate.distance");
  EXPECT_LT(distance.back(), distance.front() - 0.3);
}

TEST(Worlds, TheWarehouseMissionTakesOffTowardsItsGate) {
  const Folder folder;
  expect_on_the_way(first_seconds("warehouse", folder));
}

TEST(Worlds, TheForestMissionTakesOffTowardsItsGate) {
  const Folder folder;
  expect_on_the_way(first_seconds("forest", folder));
}

TEST(Worlds, ACrazyflieOnItsOwnEstimateTakesOffInTheWarehouse) {
  const Folder folder;
  const auto flight = first_seconds("warehouse", folder,
                                    {"world.stabiliser.controller=crazyflie", "world.stabiliser.state=estimate",
                                     "world.range.model=cone", "world.imu.rate_noise=0.006"});
  expect_on_the_way(flight);
  const auto truth = column(flight.results, "world.drone.position.z");
  const auto estimate = column(flight.results, "world.estimate.position.z");
  EXPECT_NEAR(estimate.back(), truth.back(), 0.1);
  EXPECT_NE(estimate.back(), truth.back());
}

}  // namespace
}  // namespace mebots::system_test
