// SPDX-License-Identifier: Apache-2.0
#include "missions.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>

namespace mebots::system_test {
namespace {

using ::testing::HasSubstr;

/// Returns a shipped config that records every communication point, as some tests need.
nlohmann::ordered_json every_point(const std::string& name) {
  auto config = shipped_config(name);
  config.erase("record");
  return config;
}

/// Runs the easy mission once for all its tests.
class GateEasy : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new Folder;
    config_ = write(*folder_ / "gate_easy.json", every_point("gate_easy"));
    flight_ = new Flight(fly(config_, *folder_ / "first"));
  }
  static void TearDownTestSuite() {
    delete flight_;
    delete folder_;
  }

  static std::vector<double> values(const std::string& name) { return column(flight_->results, name); }

  static Folder* folder_;
  static std::filesystem::path config_;
  static Flight* flight_;
};

Folder* GateEasy::folder_ = nullptr;
std::filesystem::path GateEasy::config_;
Flight* GateEasy::flight_ = nullptr;

TEST_F(GateEasy, DroneTakesOffPassesTheGateAndLands) {
  ASSERT_EQ(flight_->exit_code, 0) << flight_->output;
  EXPECT_EQ(flight_->summary.at("outcome"), "passed") << flight_->output;
  const auto altitude = values("world.drone.position.z");
  // While the motors start, the reference altitude already rises. Therefore the drone may overshoot the altitude.
  EXPECT_NEAR(*std::max_element(altitude.begin(), altitude.end()), 1.0, 0.2);
  EXPECT_LT(altitude.back(), 0.05);
  EXPECT_EQ(values("world.gate.touched").back(), 0);
}

TEST(Mission, EndsSoonAfterItsFirmwareCannotContinue) {
  const Folder folder;
  const auto flight = fly(write(folder / "gate_easy.json", shipped_config("gate_easy")), folder / "out",
                          {std::string("soc.firmware=") + CXX_FIRMWARE});
  EXPECT_EQ(flight.summary.at("outcome"), "firmware_fault") << flight.output;
  EXPECT_LT(flight.summary.at("simulated_time").get<double>(), 1.0) << "it does not wait for a landing";
  EXPECT_EQ(flight.summary.at("fabric_controller").at("exit_code"), 255);
  EXPECT_EQ(flight.summary.at("fabric_controller").at("faulted"), true);
  EXPECT_THAT(flight.output, HasSubstr("after load access fault"));
  EXPECT_THAT(flight.output, HasSubstr("main.cpp:36"));
}

TEST_F(GateEasy, DroneCruisesAtTheSpeedThatItsFirmwareCommands) {
  const auto speed = values("world.drone.forward_velocity");
  const auto mode = values("soc.setpoint.mode");
  const auto asked = values("soc.setpoint.velocity.x");
  double sum = 0;
  int count = 0;
  for (std::size_t i = 1500; i < speed.size(); ++i) {
    // The stabiliser's transient ends within three seconds after a new set-point.
    if (mode[i] != 2 || asked[i] < 0.2 || asked[i] != asked[i - 1500]) continue;
    sum += speed[i];
    ++count;
  }
  ASSERT_GT(count, 1000);
  EXPECT_NEAR(sum / count, 1.0 / 3.6, 0.01);
}

TEST_F(GateEasy, EveryJouleOfTheCellIsAccountedFor) {
  const auto last = [&](const std::string& name) { return values("battery." + name).back(); };
  const double consumers = last("motors.energy") + last("soc.energy") + last("camera.energy") + last("avionics.energy");
  EXPECT_NEAR(consumers, last("energy.delivered"), 1e-6 * consumers);
  EXPECT_LT(std::abs(last("energy.imbalance")), 1e-6 * last("energy.open_circuit"));
}

TEST_F(GateEasy, BatteryDeliversWhatTheLoadsReportOneStepLater) {
  // The battery receives a load's mean power of a step one step later. Therefore its count lacks the energy of the last
  // step.
  const double reported = values("motors.energy").back();
  const double delivered = values("battery.motors.energy").back();
  const double under_way = values("motors.power").back() * 0.002;
  EXPECT_NEAR(delivered + under_way, reported, 1e-9 * reported);
}

TEST_F(GateEasy, ChipCountsWhatItsFirmwareExecutes) {
  EXPECT_GT(flight_->summary.at("fabric_controller").at("instructions").get<double>(), 1e5);
  EXPECT_GT(values("soc.cluster.instructions").back(), flight_->summary.at("pictures").get<double>() * 1'679'904 / 4)
      << "a dot product makes four of the network's 1,679,904 products";
  EXPECT_GE(flight_->summary.at("fabric_controller").at("cycles").get<double>(),
            flight_->summary.at("fabric_controller").at("instructions").get<double>());
  const double awake = flight_->summary.at("fabric_controller").at("cycles").get<double>() / 100e6;
  EXPECT_NEAR(awake + flight_->summary.at("fabric_controller").at("sleep_time").get<double>(), values("time").back(),
              0.01)
      << "busy and sleep time add up to the simulated time; awake the clock is 100 MHz but for about 30 cycles at each "
         "end of a sleep, 3 us at 10 MHz, in some 1,000 sleeps";
}

TEST_F(GateEasy, FirmwareTalksToTheUser) {
  EXPECT_THAT(flight_->output, HasSubstr("soc: "));
  EXPECT_THAT(flight_->output, HasSubstr("gate crossed, ended"));
}

TEST_F(GateEasy, SameInputGivesTheSameBits) {
  const auto second = fly(config_, *folder_ / "second");
  EXPECT_EQ(second.exit_code, 0);
  EXPECT_TRUE(second.results == flight_->results) << "results.csv differs between two runs";
}

TEST_F(GateEasy, BitsDoNotDependOnTheOrderOfInstancesAndConnections) {
  auto config = every_point("gate_easy");
  nlohmann::ordered_json reversed;
  std::vector<std::string> names;
  for (const auto& [name, entry] : config.at("instances").items()) names.push_back(name);
  std::reverse(names.begin(), names.end());
  for (const auto& name : names) reversed[name] = config.at("instances").at(name);
  config.at("instances") = reversed;
  std::reverse(config.at("connections").begin(), config.at("connections").end());
  const auto other = fly(write(*folder_ / "reversed.json", config), *folder_ / "reversed");
  ASSERT_EQ(other.exit_code, 0) << other.output;
  const auto reordered = columns(other.results);
  for (const auto& [name, expected] : columns(flight_->results)) {
    ASSERT_TRUE(reordered.contains(name)) << name;
    EXPECT_EQ(reordered.at(name), expected) << name;
  }
}

TEST_F(GateEasy, PicturesOfTheFlightAreKept) {
  const auto folder = *folder_ / "first" / "pictures" / "world.camera.frame";
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto picture = read_file(entry.path());
    EXPECT_EQ(picture.substr(1, 3), "PNG");
    EXPECT_EQ(picture.substr(16, 8), std::string("\0\0\1\x40\0\0\1\x40", 8)) << "320 x 320 pixels";
    ++count;
  }
  EXPECT_GT(count, 10);
}

/// Runs the easy mission with changed settings.
Flight fly_changed(const std::vector<std::string>& sets) {
  const Folder folder;
  return fly(write(folder / "changed.json", shipped_config("gate_easy")), folder / "out", sets);
}

TEST(Mission, EasyOneAsItIsShippedLeavesRoomForItsPage) {
  const Folder folder;
  const auto flight = fly(write(folder / "easy.json", shipped_config("gate_easy")), folder / "out");
  ASSERT_EQ(flight.exit_code, 0) << flight.output;
  std::uintmax_t bytes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "out")) {
    if (entry.is_regular_file()) bytes += entry.file_size();
  }
  EXPECT_LT(bytes, 3'600'000U) << "with its page, of 2.4 MB, within 6 MB";
  EXPECT_GT(bytes, 1'000'000U) << "table, pictures and scene are there";
}

TEST(Mission, GateIsFoundByVisionFromATurnedStart) {
  const auto flight = fly_changed({"world.start.yaw_offset=0.35"});
  EXPECT_EQ(flight.exit_code, 0);
  EXPECT_EQ(flight.summary.at("outcome"), "passed") << flight.output;
}

TEST(Mission, DroneThatSeesNothingDoesNotPass) {
  const auto flight = fly_changed({"world.camera.noise=10000"});
  EXPECT_EQ(flight.exit_code, 0) << flight.output;
  EXPECT_EQ(column(flight.results, "world.gate.passed").back(), 0)
      << "started towards the gate, but with noise alone in its pictures";
}

TEST(Mission, DroneThatHangsOnTheFrameIsStuckHoweverItsCellEnds) {
  // The drone starts a metre in front of the gate's left post, and does not steer.
  const auto flight = fly_changed({"world.start.offset.x=4", "world.start.offset.y=0.45",
                                   "soc.mission.yaw_rate_scale=0", "battery.cell.initial_state_of_charge=0.2"});
  EXPECT_EQ(flight.exit_code, 0) << flight.output;
  EXPECT_EQ(flight.summary.at("outcome"), "stuck") << flight.output;
  EXPECT_EQ(flight.summary.at("gate").at("passed"), false);
}

TEST(Mission, DroneThatComesBackThroughTheGateIsTurnedBack) {
  // Moves the drone backwards when it has passed the gate. Lands the drone one second after it has flown back through
  // the gate.
  auto config = shipped_config("gate_easy");
  config["scenario"] = nlohmann::ordered_json::parse(R"([
    {"variable": "world.setpoint.velocity.x", "set": -0.3,
     "when": {"variable": "world.gate.passed", "equals": true}},
    {"variable": "world.setpoint.mode", "set": "land",
     "when": {"variable": "world.gate.turned_back", "equals": true, "for": 1}}
  ])");
  const Folder folder;
  const auto flight = fly(write(folder / "pulled.json", config), folder / "out", {"world.start.offset.x=4"});
  EXPECT_EQ(flight.exit_code, 0) << flight.output;
  EXPECT_EQ(flight.summary.at("outcome"), "turned_back") << flight.output;
  EXPECT_EQ(flight.summary.at("gate").at("crossed"), true);
  EXPECT_EQ(flight.summary.at("landed"), true);
}

TEST(Mission, CellThatIsFlatInMidAirBringsTheDroneDown) {
  const auto flight = fly_changed({"battery.cell.initial_state_of_charge=0.02", "soc.mission.landing_charge=0"});
  EXPECT_EQ(flight.exit_code, 0) << "a flat cell is a result, not a failure\n" << flight.output;
  EXPECT_EQ(flight.summary.at("outcome"), "battery_empty");
  EXPECT_EQ(column(flight.results, "battery.bus.voltage").back(), 0);
  EXPECT_LT(column(flight.results, "world.drone.position.z").back(), 0.1);
}

TEST(Mission, LowChargeMakesTheDroneLand) {
  const auto flight = fly_changed({"battery.cell.initial_state_of_charge=0.13"});
  EXPECT_EQ(flight.exit_code, 0);
  EXPECT_EQ(flight.summary.at("outcome"), "battery_empty") << flight.output;
  EXPECT_EQ(column(flight.results, "world.drone.landed").back(), 1);
}

TEST(Mission, FirmwareThatFaultsLeavesResultsAndAMessage) {
  const Folder folder;
  const auto elf = folder / "lost.elf";
  const auto source = folder / "lost.S";
  std::ofstream(source) << ".globl _start\n_start: lui t0, 0x40000\n jr t0\n";  // jumps to an address without code
  const std::string build =
      "riscv64-unknown-elf-gcc -nostdlib -march=rv32imc_zicsr -mabi=ilp32 -Wl,-N,-Ttext=0x1C000000 '" +
      source.string() + "' -o '" + elf.string() + "'";
  ASSERT_EQ(std::system(build.c_str()), 0);
  const auto flight = fly(write(folder / "c.json", every_point("gate_easy")), folder / "out",
                          {"soc.firmware=" + elf.string()}, {"--stop-time", "0.1"});
  EXPECT_EQ(flight.exit_code, 0) << "a fault of the firmware is model behaviour\n" << flight.output;
  EXPECT_THAT(flight.output, HasSubstr("40000000")) << "the message names where the program counter went";
  EXPECT_EQ(column(flight.results, "soc.core.faulted").back(), 1);
  EXPECT_EQ(flight.summary.at("fabric_controller").at("faulted"), true);
  EXPECT_FALSE(flight.summary.contains("lateral_error")) << "a flight that never came to the gate has none";
  EXPECT_EQ(column(flight.results, "time").size(), 51U);
}

}  // namespace
}  // namespace mebots::system_test
