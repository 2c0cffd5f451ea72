// SPDX-License-Identifier: Apache-2.0
#include "missions.hpp"

#include <gmock/gmock.h>

#include <fstream>

namespace mebots::system_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Runs the easy mission with a change that must prevent its start.
Flight refused(const std::function<void(nlohmann::ordered_json&)>& change, const std::vector<std::string>& sets = {}) {
  const Folder folder;
  auto config = shipped_config("gate_easy");
  change(config);
  return fly(write(folder / "bad.json", config), folder / "out", sets, {"--quiet"});
}

Flight refused(const std::vector<std::string>& sets) {
  return refused([](auto&) {}, sets);
}

TEST(BadInput, MissingFirmwareIsNamed) {
  const auto flight = refused({"soc.firmware=/nowhere/gate.elf"});
  EXPECT_EQ(flight.exit_code, 2);
  EXPECT_THAT(flight.output, AllOf(HasSubstr("soc"), HasSubstr("/nowhere/gate.elf")));
}

TEST(BadInput, FirmwareForAnotherMachineIsNamed) {
  const auto flight = refused({std::string("soc.firmware=") + X86_PROGRAM});
  EXPECT_EQ(flight.exit_code, 2);
  EXPECT_THAT(flight.output, AllOf(HasSubstr("soc"), HasSubstr(X86_PROGRAM), HasSubstr("64-bit")));
}

TEST(BadInput, ATraceOnAFullDiskIsReported) {
  const Folder folder;
  const auto flight = fly(write(folder / "easy.json", shipped_config("gate_easy")), folder / "out",
                          {"soc.observe.trace=/dev/full"}, {"--quiet", "--stop-time", "0.1"});
  EXPECT_THAT(flight.output, AllOf(HasSubstr("observe.trace /dev/full"), HasSubstr("is the disk full")));
}

TEST(BadInput, NegativeMassIsRefusedWithItsLimit) {
  const auto flight = refused({"world.drone.dry_mass=-0.01"});
  EXPECT_EQ(flight.exit_code, 2);
  EXPECT_THAT(flight.output, AllOf(HasSubstr("world"), HasSubstr("drone.dry_mass"), HasSubstr("-0.01")));
}

TEST(BadInput, UnknownCellIsNamed) {
  const auto flight = refused({"battery.cell.name=bitcraze_25"});
  EXPECT_EQ(flight.exit_code, 2);
  EXPECT_THAT(flight.output, AllOf(HasSubstr("battery"), HasSubstr("bitcraze_25")));
}

TEST(BadInput, ConnectionOfDifferentUnitsIsRefused) {
  const auto flight = refused([](auto& config) {
    config.at("connections").push_back({{"from", "battery.cell.voltage"}, {"to", "world.wind.velocity.x"}});
  });
  EXPECT_EQ(flight.exit_code, 2);
  EXPECT_THAT(flight.output, AllOf(HasSubstr("battery.cell.voltage"), HasSubstr("world.wind.velocity.x"),
                                   HasSubstr("V"), HasSubstr("m/s")));
}

TEST(BadInput, UnknownVariableComesWithTheNearestName) {
  const auto flight = refused({"world.drone.dry_mas=0.03"});
  EXPECT_EQ(flight.exit_code, 2);
  EXPECT_THAT(flight.output, AllOf(HasSubstr("drone.dry_mas"), HasSubstr("drone.dry_mass")));
}

TEST(BadInput, SceneWithANegativeSizeIsRefused) {
  const Folder folder;
  auto scene = nlohmann::ordered_json::parse(
      read_file(std::filesystem::path(MEBOTS_SOURCE_DIR) / "fmu_world" / "params" / "scenes" / "gate_easy.json"));
  scene.at("gates").at(0).at("inner") = -0.4;
  scene.at("drone") = std::string(MEBOTS_SOURCE_DIR) + "/fmu_world/params/drones/crazyflie.json";
  const auto path = write(folder / "scene.json", scene);
  const auto flight = refused({"world.scene.name=" + path.string()});
  EXPECT_EQ(flight.exit_code, 2);
  EXPECT_THAT(flight.output, AllOf(HasSubstr(path.string()), HasSubstr("inner"), HasSubstr("-0.4")));
}

TEST(BadInput, TruncatedFmuIsNamed) {
  const Folder folder;
  auto config = shipped_config("gate_easy");
  const auto whole = read_file(MEBOTS_FMU_DIR "/fmu_motors.fmu");
  const auto path = folder / "half.fmu";
  std::ofstream(path, std::ios::binary) << whole.substr(0, whole.size() / 2);
  config.at("instances").at("motors").at("fmu") = path.string();
  const auto flight = fly(write(folder / "bad.json", config), folder / "out", {}, {"--quiet"});
  EXPECT_EQ(flight.exit_code, 2);
  EXPECT_THAT(flight.output, HasSubstr("half.fmu"));
}

}  // namespace
}  // namespace mebots::system_test
