// SPDX-License-Identifier: Apache-2.0
#include "fmu/model.hpp"

#include "assembler.hpp"
#include "support/allocations.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace mebots::soc::test {
namespace {

using testing::HasSubstr;

constexpr std::int64_t kMs = 1'000'000;

/// Returns the path of a folder with the FMU's resources: the board and the gate firmware.
std::filesystem::path resources() {
  static const auto folder = [] {
    const auto path = std::filesystem::temp_directory_path() / fmt::format("mebots-soc-model-{}", getpid());
    std::filesystem::create_directories(path);
    const auto overwrite = std::filesystem::copy_options::overwrite_existing;
    std::filesystem::copy_file(MEBOTS_SOURCE_DIR "/configs/boards/ai_deck.json", path / "ai_deck.json", overwrite);
    std::filesystem::copy_file(MEBOTS_BINARY_DIR "/firmware/gate.elf", path / "gate.elf", overwrite);
    return path;
  }();
  return folder;
}

/// Assembles a program for L2, and returns the path of its file.
std::string program(std::string_view name, std::string_view text) {
  const auto path = resources() / name;
  const auto bytes = assemble_file(text, 0x1C000000);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return path.string();
}

/// Returns a program that requests a picture and waits for it. It stores the sum of the bytes as altitude set-point
/// [um], and exits with code 9.
std::string picture_program() {
  return program("picture.elf", R"(
#include "board.h"
_start: li s0, CAMERA_BASE
    li s1, FLIGHT_BASE
    li s2, 0x1C040000
    sw s2, CAMERA_BUFFER_OFFSET(s0)
    li a0, 4096
    sw a0, CAMERA_BUFFER_SIZE_OFFSET(s0)
    li a0, 1
    sw a0, CAMERA_CONTROL_OFFSET(s0)
1:  lw a0, CAMERA_STATUS_OFFSET(s0)
    andi a0, a0, 2
    beqz a0, 1b
    li a1, 128
    li a2, 0
2:  lbu a3, 0(s2)
    add a2, a2, a3
    addi s2, s2, 1
    addi a1, a1, -1
    bnez a1, 2b
    sw a2, FLIGHT_ALTITUDE_OFFSET(s1)
    li a0, 2
    sw a0, FLIGHT_MODE_OFFSET(s1)
    sw zero, FLIGHT_COMMIT_OFFSET(s1)
    li s0, POWER_MANAGER_BASE
    li a0, 9
    sw a0, POWER_MANAGER_EXIT_OFFSET(s0)
3:  j 3b
)");
}

Variables picture_variables() {
  Variables variables;
  variables.parameters.firmware = picture_program();
  variables.parameters.camera_frame_width = 16;
  variables.parameters.camera_frame_height = 8;
  return variables;
}

TEST(Model, RunsTheGateFirmwareAloneWithInputsAtTheirStartValues) {
  for (const std::int64_t h : {2 * kMs, 100 * kMs}) {
    Variables variables;
    std::vector<std::string> console;
    std::vector<std::string> faults;
    Model model(variables, resources(),
                {[&](std::string_view line) { console.emplace_back(line); },
                 [&](std::string_view text) { faults.emplace_back(text); }});
    model.start(0);
    EXPECT_TRUE(variables.outputs.core_running);
    for (std::int64_t t = 0; t < 1000 * kMs; t += h) model.step(t, h);
    EXPECT_TRUE(variables.outputs.core_running);
    EXPECT_FALSE(variables.outputs.core_faulted);
    EXPECT_GT(variables.outputs.instructions, 1000);
    EXPECT_FALSE(console.empty());
    EXPECT_TRUE(faults.empty());
  }
}

TEST(Model, ABareNameSelectsAProgramInsideTheFmu) {
  picture_program();  // writes the file picture.elf
  Variables variables;
  variables.parameters.firmware = "picture";
  variables.parameters.camera_frame_width = 16;
  variables.parameters.camera_frame_height = 8;
  Model model(variables, resources(), {});
  model.start(0);
  for (std::int64_t t = 0; t < 10 * kMs; t += 2 * kMs) model.step(t, 2 * kMs);
  EXPECT_EQ(variables.outputs.camera_trigger, 1)
      << "it asks for a picture, which the gate firmware on its ground does not";
}

TEST(Model, PowerIsTheMeanOverTheStepSoThatItSumsToTheEnergy) {
  Variables variables;
  Model model(variables, resources(), {});
  model.start(0);
  double chip_j = 0;
  double camera_j = 0;
  for (std::int64_t t = 0; t < 500 * kMs; t += 2 * kMs) {
    model.step(t, 2 * kMs);
    chip_j += variables.outputs.power_w * 2e-3;
    camera_j += variables.outputs.camera_power_w * 2e-3;
  }
  EXPECT_NEAR(chip_j, variables.outputs.energy_total_j, 1e-12 * chip_j + 1e-16) << "rounding of 250 differences";
  EXPECT_NEAR(camera_j, variables.outputs.camera_energy_j, 1e-12 * camera_j + 1e-16);
  double parts_j = 0;
  for (const double part_j : variables.outputs.energy_j) parts_j += part_j;
  EXPECT_NEAR(parts_j, variables.outputs.energy_total_j, 1e-15 * 12 * parts_j) << "rounding of eleven sums";
}

/// Returns the path of a resources folder whose board has other energies.
std::filesystem::path resources_with(std::string_view energies) {
  const auto path = resources() / energies;
  std::filesystem::create_directories(path);
  std::filesystem::copy(resources() / "gate.elf", path, std::filesystem::copy_options::overwrite_existing);
  std::ifstream file(resources() / "ai_deck.json");
  std::string board(std::istreambuf_iterator<char>(file), {});
  constexpr std::string_view kEnergy = R"("energy": "gap8_silicon")";
  board.replace(board.find(kEnergy), kEnergy.size(), fmt::format(R"("energy": "{}")", energies));
  std::ofstream(path / "ai_deck.json") << board;
  return path;
}

TEST(Model, ReportsTheRangeOfItsEnergyChecks) {
  for (const auto* energies : {"gap8", "gap8_silicon"}) {
    const auto folder = resources_with(energies);
    const auto& checks = chip_of(read_board(folder / "ai_deck.json")).checks;
    EXPECT_LT(0, checks.least);
    EXPECT_LT(checks.least, 1) << "the figures themselves lie between their checks";
    EXPECT_GT(checks.most, 1);
    Variables variables;
    Model model(variables, folder, {});
    model.start(0);
    model.step(0, 100 * kMs);
    const auto& outputs = variables.outputs;
    EXPECT_GT(outputs.energy_total_j, 0);
    EXPECT_EQ(outputs.energy_total_least_j, checks.least * outputs.energy_total_j);
    EXPECT_EQ(outputs.energy_total_most_j, checks.most * outputs.energy_total_j);
    EXPECT_THAT(outputs.energy_checks, testing::StartsWith(fmt::format("{} checks of {}:", checks.count, energies)));
  }
}

TEST(Energies, AreSelectedByNameAndMovedWithinTheirChecks) {
  const auto folder = resources_with("gap8");
  const auto joules = [&](const std::string& name, double position) {
    Variables variables;
    variables.parameters.energy_name = name;
    variables.parameters.calibration_energy = position;
    Model model(variables, folder, {});
    model.start(0);
    model.step(0, 100 * kMs);
    const auto& outputs = variables.outputs;
    const auto& checks = (name == "gap8_silicon" ? gap8_silicon() : gap8()).checks;
    EXPECT_NEAR(outputs.power_w * 0.1, outputs.energy_total_j, 1e-12);
    EXPECT_NEAR(outputs.energy_total_most_j / outputs.energy_total_least_j, checks.most / checks.least, 1e-12);
    return outputs.energy_total_j;
  };
  EXPECT_EQ(joules("", 0), joules("gap8", 0));
  EXPECT_NE(joules("gap8_silicon", 0), joules("gap8", 0));
  EXPECT_NEAR(joules("gap8", 1) / joules("gap8", 0), gap8().checks.most, 1e-12);
  EXPECT_NEAR(joules("gap8_silicon", -0.5) / joules("gap8_silicon", 0), (1 + gap8_silicon().checks.least) / 2, 1e-12);
  EXPECT_THROW(joules("gap9", 0), Error);
  EXPECT_THROW(joules("gap8", 1.5), Error);
}

/// Core n of four runs 100 (n + 1) iterations of a loop, then sleeps.
TEST(Model, ReportsTheCyclesOfEachClusterCore) {
  Variables variables;
  variables.parameters.firmware = program("cores.elf", R"(
#include "board.h"
_start: li s0, POWER_MANAGER_BASE
    la a0, core
    sw a0, POWER_MANAGER_CLUSTER_BOOT_OFFSET(s0)
    li a0, 1
    sw a0, POWER_MANAGER_CLUSTER_POWER_OFFSET(s0)
1:  wfi
    j 1b
core: csrr a0, mhartid
    addi a0, a0, 1
    li a1, 100
    mul a0, a0, a1
2:  addi a0, a0, -1
    bnez a0, 2b
3:  wfi
    j 3b
)");
  variables.parameters.cluster_cores = 4;
  Model model(variables, resources(), {});
  model.start(0);
  for (std::int64_t t = 0; t < 4 * kMs; t += 2 * kMs) model.step(t, 2 * kMs);
  const auto& cycles = variables.outputs.cluster_core_cycles;
  EXPECT_EQ(cycles[0] + cycles[1] + cycles[2] + cycles[3], variables.outputs.cluster_cycles);
  const auto turn = (cycles[3] - cycles[0]) / 300;
  EXPECT_GE(turn, 2) << "an addition and a branch that is taken";
  for (std::size_t core = 0; core < 4; ++core) {
    EXPECT_NEAR(cycles[core], 100 * static_cast<double>(core + 1) * turn, 200) << "core " << core << ": first fetches";
  }
  for (std::size_t core = 4; core < cycles.size(); ++core) EXPECT_EQ(cycles[core], 0) << "there is no core " << core;
}

TEST(Model, PictureByPointerAndByBase64GiveTheSame) {
  const std::vector<std::uint8_t> picture(128, 200);
  std::string text;  // 128 bytes of the value 200: groups of "yMjI", then two bytes
  for (int i = 0; i < 42; ++i) text += "yMjI";
  text += "yMg=";
  std::vector<double> answered_at;
  for (const bool by_pointer : {true, false}) {
    auto variables = picture_variables();
    Model model(variables, resources(), {});
    model.start(0);
    for (std::int64_t t = 0; t < 40 * kMs; t += 2 * kMs) {
      model.step(t, 2 * kMs);
      if (variables.outputs.core_exit_code != 0 && answered_at.size() == (by_pointer ? 0 : 1)) {
        answered_at.push_back(static_cast<double>(t + 2 * kMs));
      }
      if (variables.outputs.camera_trigger != variables.inputs.camera_frame_id) {
        // Like the world, provides the picture one step after the request.
        variables.inputs.camera_frame_id = variables.outputs.camera_trigger;
        if (by_pointer) {
          variables.inputs.camera_frame = fmu::BinaryRef::to(picture);
        } else {
          variables.inputs.camera_frame_base64 = text;
        }
      }
    }
    EXPECT_EQ(variables.outputs.camera_trigger, 1);
    EXPECT_EQ(variables.outputs.setpoint_mode, FlightMode::fly);
    EXPECT_NEAR(variables.outputs.setpoint_altitude_m, 128 * 200e-6, 1e-15);
    EXPECT_EQ(variables.outputs.core_exit_code, 9);
    EXPECT_FALSE(variables.outputs.core_running);
    EXPECT_FALSE(variables.outputs.core_faulted);
  }
  // The world sees the request at 2 ms, after the first step, and its picture arrives at 2 ms. The picture is complete
  // 16.6667 ms later, so the answer is visible at 20 ms.
  EXPECT_THAT(answered_at, testing::ElementsAre(20e6, 20e6));
}

TEST(Model, InvalidBase64IsAnError) {
  auto variables = picture_variables();
  Model model(variables, resources(), {});
  model.start(0);
  model.step(0, 2 * kMs);
  variables.inputs.camera_frame_id = 1;
  variables.inputs.camera_frame_base64 = "not base64!!";
  EXPECT_THROW(model.step(2 * kMs, 2 * kMs), Error);
}

TEST(Model, SwitchesOffForGoodBelow2Point5Volt) {
  Variables variables;
  std::vector<std::string> faults;
  Model model(variables, resources(), {{}, [&](std::string_view text) { faults.emplace_back(text); }});
  model.start(0);
  model.step(0, 2 * kMs);
  EXPECT_GT(variables.outputs.power_w, 0);
  variables.inputs.battery_voltage_v = 2.4;
  model.step(2 * kMs, 2 * kMs);
  EXPECT_EQ(variables.outputs.power_w, 0);
  EXPECT_EQ(variables.outputs.camera_power_w, 0);
  EXPECT_FALSE(variables.outputs.core_running);
  variables.inputs.battery_voltage_v = 3.7;
  model.step(4 * kMs, 2 * kMs);
  EXPECT_EQ(variables.outputs.power_w, 0);
  ASSERT_EQ(faults.size(), 1U) << "said once";
  EXPECT_THAT(faults[0], HasSubstr("2.4 V is under 2.5 V"));
}

TEST(Model, NamesTheParameterIfTheFirmwareIsMissing) {
  Variables variables;
  variables.parameters.firmware = "/nowhere/fw.elf";
  try {
    const Model model(variables, resources(), {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("firmware = \"/nowhere/fw.elf\""));
    EXPECT_THAT(error.what(), HasSubstr("inside the FMU: "));
    EXPECT_THAT(error.what(), HasSubstr("gate"));
  }
}

/// Returns a folder like that of `mebots deploy`, with `flight` in its network.json.
std::filesystem::path network_folder(std::string_view flight) {
  const auto folder = resources() / "network";
  std::filesystem::create_directories(folder);
  std::filesystem::copy_file(picture_program(), folder / "gate.elf", std::filesystem::copy_options::overwrite_existing);
  std::ofstream(folder / "network.json") << fmt::format(R"({{"format": 1, "flight": {}}})", flight);
  return folder;
}

/// Returns the error of a chip with this network and firmware.
std::string network_error(const std::filesystem::path& folder, std::string_view firmware) {
  Variables variables;
  variables.parameters.firmware = firmware;
  variables.parameters.network = folder;
  try {
    const Model model(variables, resources(), {});
    return "none";
  } catch (const Error& error) {
    return error.what();
  }
}

constexpr auto kFlight =
    R"({"program": "gate.elf", "board": "ai_deck", "firmware": ["gate", "gap8_gate"], "outputs": ["yaw"]})";

TEST(Network, ReplacesTheFirmwareByTheProgramOfItsFolder) {
  auto variables = picture_variables();
  variables.parameters.firmware = "";
  variables.parameters.network = network_folder(kFlight);
  Model model(variables, resources(), {});
  model.start(0);
  model.step(0, 20 * kMs);
  EXPECT_EQ(variables.outputs.camera_trigger, 1)
      << "it asks for a picture, which the gate firmware on its ground does not";
}

TEST(Network, OfAnotherFirmwareIsRefusedWithItsOutputs) {
  const auto text = network_error(network_folder(kFlight), "sight");
  EXPECT_THAT(text, HasSubstr("network = \""));
  EXPECT_THAT(text, HasSubstr("outputs (yaw)"));
  EXPECT_THAT(text, HasSubstr("of firmware gate or gap8_gate, but the mission flies firmware sight"));
}

TEST(Network, OfAnotherBoardIsRefused) {
  const auto folder =
      network_folder(R"({"program": "gate.elf", "board": "other", "firmware": ["gate"], "outputs": ["yaw"]})");
  EXPECT_THAT(network_error(folder, "gate"), HasSubstr("gate.elf is for board other, and this chip is board ai_deck"));
}

TEST(Network, ThatDoesNotFlyIsRefusedWithTheReason) {
  EXPECT_THAT(network_error(network_folder(R"({"none": "its input has 3 channels"})"), "gate"),
              HasSubstr("does not fly: its input has 3 channels"));
}

TEST(Network, OfABrokenFolderIsRefusedWithThePlace) {
  EXPECT_THAT(network_error(resources() / "absent", "gate"), HasSubstr("there is no such folder"));
  EXPECT_THAT(network_error(resources(), "gate"), HasSubstr("no network.json"));
  EXPECT_THAT(network_error(network_folder("3"), "gate"), HasSubstr("network.json:1:"));
  const auto outside =
      network_folder(R"({"program": "../gate.elf", "board": "ai_deck", "firmware": ["gate"], "outputs": ["yaw"]})");
  EXPECT_THAT(network_error(outside, "gate"), HasSubstr("must be the name of a file in this folder"));
}

TEST(Model, NanAsInputIsAnError) {
  Variables variables;
  Model model(variables, resources(), {});
  model.start(0);
  variables.inputs.flight_range_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(model.step(0, kMs), Error);
}

TEST(Model, RefusesAStepBeyondItsLongestTime) {
  Variables variables;
  Model model(variables, resources(), {});
  model.start(0);
  try {
    model.step(0, 9'000'001'000'000'000);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("9000000 s after its start"));
  }
}

/// The gate firmware gets the same picture repeatedly.
TEST(Model, AllocatesNothingInAStepAfterItsCodeIsTranslated) {
  Variables variables;
  const std::vector<std::uint8_t> picture(320 * 240, 100);
  variables.parameters.camera_frame_height = 240;
  Model model(variables, resources(), {});
  variables.inputs.battery_voltage_v = 3.9;
  variables.inputs.battery_state_of_charge = 1;
  variables.inputs.flight_range_m = 1;
  model.start(0);
  long before = 0;
  for (std::int64_t step = 0; step < 15'000; ++step) {
    if (step == 10'000) before = mebots::test::allocations();
    // The drone has left the ground after a second.
    variables.inputs.flight_phase = step < 500 ? FlightPhase::climbing : FlightPhase::flying;
    variables.inputs.camera_frame = fmu::BinaryRef::to(picture);
    variables.inputs.camera_frame_id = variables.outputs.camera_trigger;
    model.step(step * 2 * kMs, 2 * kMs);
  }
  EXPECT_GT(variables.outputs.camera_trigger, 50) << "pictures went through";
  EXPECT_EQ(variables.outputs.core_exit_code, 0) << "flies on";
  EXPECT_EQ(mebots::test::allocations() - before, 0);
}

}  // namespace
}  // namespace mebots::soc::test
