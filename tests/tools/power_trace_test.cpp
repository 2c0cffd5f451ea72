// SPDX-License-Identifier: Apache-2.0
// Tests power over time: the integral is the energy, and states follow each other without gaps.
#include "observe/power_trace.hpp"

#include "board_system.hpp"
#include "support.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <map>
#include <sstream>

namespace mebots::soc::test {
namespace {

/// A loop that computes, requests a picture, changes the voltage, and sleeps until the picture arrives.
constexpr std::string_view kProgram = R"(
_start: la t0, handler
    csrw mtvec, t0
    li s1, CAMERA_BASE
    li s4, POWER_MANAGER_BASE
    li a0, 0x1C040000
    sw a0, CAMERA_BUFFER_OFFSET(s1)
    li a0, 65536
    sw a0, CAMERA_BUFFER_SIZE_OFFSET(s1)
    li a0, 1 << CAMERA_INTERRUPT
    csrw mie, a0
again: csrwi mstatus, 8
    li a0, 50000
2:  addi a0, a0, -1
    bnez a0, 2b
    li a0, 1
    sw a0, CAMERA_CONTROL_OFFSET(s1)
    li a0, 1000
    sw a0, POWER_MANAGER_VOLTAGE_MV_OFFSET(s4)
    wfi
    li a0, 1200
    sw a0, POWER_MANAGER_VOLTAGE_MV_OFFSET(s4)
    j again
    .balign 4
handler: li a5, 2
    sw a5, CAMERA_STATUS_OFFSET(s1)
    mret
)";

constexpr std::int64_t kEnd = 50'000'000;

struct Traced {
  explicit Traced(std::string_view file) : system(kProgram) {
    observe::PowerTrace trace("--power-trace", folder / file, system.soc);
    system.soc.listen(&trace);
    for (std::int64_t t = 0; t < kEnd; t += 2'000'000) {
      auto& camera = system.camera();
      if (camera.wants(camera.requests())) camera.offer(std::vector<std::uint8_t>(320UL * 100, 9), system.soc.now());
      system.soc.advance(t + 2'000'000);
    }
    system.soc.listen(nullptr);
    trace.finish();
    written = read_file(folder / file);
  }
  Folder folder;
  BoardSystem system;
  std::string written;
};

TEST(PowerTrace, ForPerfettoHasTheEnergyAsItsArea) {
  const Traced run("p.json");
  const auto json = nlohmann::json::parse(run.written);
  std::map<std::string, double> area_j;
  std::map<std::string, std::pair<double, double>> last;  // start [us], value
  const auto close = [&](const std::string& name, double at) {
    area_j[name] += last[name].second * (at - last[name].first) * 1e-6;
  };
  for (const auto& event : json["traceEvents"]) {
    if (event["ph"] != "C") continue;
    const auto name = event["name"].get<std::string>();
    const auto at = event["ts"].get<double>();
    EXPECT_GE(at, last[name].first);
    close(name, at);
    last[name] = {at, event["args"]["value"].get<double>()};
  }
  double chip_j = 0;
  for (const auto& [name, value] : last) {
    close(name, kEnd * 1e-3);
    if (name.starts_with("power.")) chip_j += area_j[name];
  }
  // The file contains values with 9 digits.
  EXPECT_NEAR(chip_j, run.system.soc.energy().total_j(), 1e-8 * chip_j);
  EXPECT_NEAR(area_j["camera.power [W]"], run.system.camera_energy_j(), 1e-8);
  EXPECT_EQ(last.count("clock [Hz]"), 1U);
  EXPECT_EQ(last.count("voltage [V]"), 1U);
}

TEST(PowerTrace, ForPerfettoHasStatesOneAfterTheOther) {
  const Traced run("p.json");
  const auto json = nlohmann::json::parse(run.written);
  std::map<int, std::string> names;
  std::map<int, double> end;
  std::map<std::string, std::vector<std::string>> states;
  for (const auto& event : json["traceEvents"]) {
    if (event["ph"] == "M" && event["name"] == "thread_name") names[event["tid"]] = event["args"]["name"];
    if (event["ph"] != "X") continue;
    const auto tid = event["tid"].get<int>();
    EXPECT_NEAR(event["ts"].get<double>(), end[tid], 1e-6) << "ts has a picosecond's digit";
    end[tid] = event["ts"].get<double>() + event["dur"].get<double>();
    states[names[tid]].push_back(event["name"]);
  }
  ASSERT_GE(states["core"].size(), 4U);
  EXPECT_EQ(states["core"][0], "active");
  EXPECT_EQ(states["core"][1], "asleep");
  ASSERT_GE(states["camera"].size(), 4U);
  EXPECT_EQ(states["camera"][0], "idle");
  EXPECT_EQ(states["camera"][1], "waiting for the picture");
  EXPECT_EQ(states["camera"][2], "active");
  EXPECT_EQ(states["camera"][3], "idle");
  for (const auto& [tid, at] : end) EXPECT_NEAR(at, kEnd * 1e-3, 1e-6);
}

TEST(PowerTrace, ForGtkwaveIsAValueChangeDumpInTheOrderOfTime) {
  const Traced run("p.vcd");
  std::istringstream lines(run.written);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "$timescale 1ps $end");
  long long time = -1;
  int asleep = 0;
  while (std::getline(lines, line)) {
    if (line.starts_with("#")) {
      const auto next = std::stoll(line.substr(1));
      EXPECT_GT(next, time);
      time = next;
    }
    if (line.starts_with("sasleep ")) ++asleep;
  }
  EXPECT_EQ(time, kEnd * 1000);
  EXPECT_GE(asleep, 2);
}

}  // namespace
}  // namespace mebots::soc::test
