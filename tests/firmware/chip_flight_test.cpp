// SPDX-License-Identifier: Apache-2.0
// Tests the built firmware on the simulated chip, with pictures of the real renderer and a simple model of the drone.
// Signals are exchanged as in a co-simulation: an output takes effect at the communication point at which it is read.

#include "app/navigator.h"

#include "devices/generic/camera.hpp"
#include "plain_drone.hpp"
#include "rendered_world.hpp"
#include "soc/soc.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace mebots::firmware_test {
namespace {

using testing::Contains;
using testing::HasSubstr;

constexpr std::int64_t kStepNs = 2'000'000;
constexpr double kStep_s = 0.002;

enum Phase { kOnGround, kClimbing, kFlying, kDescending, kLanded, kCrashed };
enum Mode { kOff, kTakeOff, kFly, kLand };

struct FlightParameters {
  double cruise_speed_m_per_s = 0.2777778;
  double altitude_m = 1.0;
  double frame_period_s = 0.1;
  double yaw_rate_scale_rad_per_s = 0.5;
  double landing_charge = 0.1;
  double policy = 0;
  double initial_speed_m_per_s = 0.2777778;
  double navigator = 0;
  double sleep_clock_hz = 10e6;

  void put_into(const soc::Soc& chip) const {
    *chip.devices().input("mission.cruise_speed") = cruise_speed_m_per_s;
    *chip.devices().input("mission.altitude") = altitude_m;
    *chip.devices().input("mission.frame_period") = frame_period_s;
    *chip.devices().input("mission.yaw_rate_scale") = yaw_rate_scale_rad_per_s;
    *chip.devices().input("mission.landing_charge") = landing_charge;
    *chip.devices().input("mission.policy") = policy;
    *chip.devices().input("mission.initial_speed") = initial_speed_m_per_s;
    *chip.devices().input("mission.navigator") = navigator;
    *chip.devices().input("mission.sleep_clock") = sleep_clock_hz;
  }
};

/// The set-points that the chip sends to the flight controller.
struct SetPoint {
  explicit SetPoint(const soc::Soc& chip)
      : mode(static_cast<int>(*chip.devices().output("setpoint.mode"))),
        velocity_x(*chip.devices().output("setpoint.velocity.x")),
        yaw_rate(*chip.devices().output("setpoint.yaw_rate")),
        altitude(*chip.devices().output("setpoint.altitude")) {}

  int mode;
  double velocity_x;
  double yaw_rate;
  double altitude;
};

struct Surroundings {
  bool with_gate = true;
  bool with_pictures = true;
  double charge = 1.0;
  double charge_per_second = 0.0;
  double crash_at_s = 1e9;
  std::uint32_t picture_edge_px = 320;
  bool on_gap8 = false;  ///< on GAP8's own devices
};

struct Outcome {
  std::vector<std::string> console;
  std::vector<navigator_output_t> answers;  ///< computed on this machine for the pictures, in order
  Crossing crossing;
  BodyPose last;
  int phase = kOnGround;
  int exit_code = -1;
  bool ended = false;
  std::string fault;
  double time_s = 0.0;
  std::uint64_t instructions = 0;
  soc::EnergyLedger energy;
};

/// Returns a picture of the size of the sensor on GAP8's board, with the given picture in its centre.
std::vector<std::uint8_t> in_the_middle(const std::vector<std::uint8_t>& picture, std::size_t edge) {
  constexpr std::size_t kSensor = 324;
  const auto margin = (kSensor - edge) / 2;
  std::vector<std::uint8_t> whole(kSensor * kSensor);
  for (std::size_t y = 0; y < edge; ++y) {
    std::copy_n(&picture[y * edge], edge, &whole[(margin + y) * kSensor + margin]);
  }
  return whole;
}

Outcome run(const FlightParameters& mission, const Surroundings& around, double limit_s) {
  Outcome outcome;
  soc::Listeners listeners;
  listeners.console = [&](std::string_view line) { outcome.console.emplace_back(line); };
  const auto board = soc::read_board(around.on_gap8 ? std::string(MEBOTS_BINARY_DIR) + "/boards/gap8_drone.json"
                                                    : std::string(MEBOTS_SOURCE_DIR) + "/configs/boards/ai_deck.json");
  const auto program =
      soc::Elf::read(std::string(MEBOTS_BINARY_DIR) + "/firmware/" + (around.on_gap8 ? "gap8_gate.elf" : "gate.elf"));
  soc::Soc chip(board, soc::gap8(), {}, program, listeners);
  mission.put_into(chip);
  auto* const eye = dynamic_cast<soc::Camera*>(chip.devices().find("camera"));  // null: GAP8's interface
  if (eye != nullptr) {
    *chip.devices().input("camera.frame_width") = around.picture_edge_px;
    *chip.devices().input("camera.frame_height") = around.picture_edge_px;
  }

  auto scene = load_scene("gate_easy");
  const auto gate = scene.gates.at(0);
  if (!around.with_gate) scene.gates.clear();
  const auto edge = static_cast<int>(around.picture_edge_px);
  Camera camera(scene, 2.0, edge, edge);
  PlainDrone drone;
  drone.pose.p_WB_m = scene.start.p_WB_m;
  drone.pose.yaw_rad = scene.start.yaw_rad;
  std::vector<std::uint8_t> picture;
  std::vector<std::uint8_t> whole;
  std::int32_t picture_id = 0;

  for (std::int64_t k = 0; !outcome.ended && k * kStep_s < limit_s; ++k) {
    outcome.time_s = k * kStep_s;
    *chip.devices().input("battery.state_of_charge") = around.charge - around.charge_per_second * outcome.time_s;
    *chip.devices().input("flight.phase") = outcome.phase;
    *chip.devices().input("flight.range") = drone.pose.p_WB_m.z();
    *chip.devices().input("flight.forward_velocity") = drone.velocity_m_s;
    *chip.devices().input("flight.yaw") = drone.pose.yaw_rad;
    if (eye == nullptr) {
      *chip.devices().input("camera.frame_id") = picture_id;
      *chip.devices().find("udma")->bytes_input("camera.frame") = whole;
      chip.begin_step();
    } else if (eye->wants(picture_id)) {
      eye->offer(picture, chip.now());
    }
    const SetPoint sent(chip);
    const auto requests = static_cast<std::int32_t>(*chip.devices().output("camera.trigger"));
    chip.advance((k + 1) * kStepNs);

    if (around.with_pictures && requests != picture_id) {
      picture = camera.take(drone.pose, 1);
      if (eye == nullptr) whole = in_the_middle(picture, around.picture_edge_px);
      picture_id = requests;
      outcome.answers.push_back(finder_navigate(picture.data(), camera.width(), camera.height()));
    }
    const Eigen::Vector3d before_m = drone.pose.p_WB_m;
    if (outcome.time_s >= around.crash_at_s) {
      outcome.phase = kCrashed;
    } else if (sent.mode == kTakeOff && outcome.phase <= kClimbing) {
      outcome.phase = drone.climb(kStep_s, sent.altitude) ? kFlying : kClimbing;
    } else if (sent.mode == kFly) {
      drone.move(kStep_s, sent.velocity_x, sent.yaw_rate);
    } else if (sent.mode == kLand && outcome.phase != kLanded) {
      drone.move(kStep_s, 0.0, 0.0);
      outcome.phase = drone.climb(kStep_s, 0.0145) ? kLanded : kDescending;
    }
    outcome.crossing.look(gate, before_m, drone.pose);
    outcome.ended = !chip.running();
  }
  outcome.last = drone.pose;
  outcome.exit_code = chip.exit_code();
  outcome.fault = chip.fault_text();
  outcome.instructions = chip.hart().counters().instructions;
  outcome.energy = chip.energy();
  return outcome;
}

constexpr FlightParameters kMission;

void show(const Outcome& outcome) {
  for (const auto& line : outcome.console) std::printf("[ console  ] %s\n", line.c_str());
}

/// Returns the outcome of the flight with the mission's defaults, which is simulated once for all tests.
const Outcome& easy_flight() {
  static const Outcome outcome = run(kMission, {}, 60.0);
  return outcome;
}

void expect_passed_the_easy_gate_and_landed(const Outcome& outcome) {
  show(outcome);
  ASSERT_TRUE(outcome.ended) << outcome.fault;
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.phase, kLanded);
  EXPECT_TRUE(outcome.crossing.clear_of(load_scene("gate_easy").gates[0]));
  EXPECT_THAT(outcome.console, Contains(HasSubstr("gate crossed, ended after")));
}

TEST(ChipFlight, FirmwareTakesOffPassesTheEasyGateLandsAndExitsWithZero) {
  const auto& outcome = easy_flight();
  std::printf("[ measured ] %.3f m left of the middle, %.0f million instructions in %.1f s\n",
              outcome.crossing.lateral_m, outcome.instructions * 1e-6, outcome.time_s);
  expect_passed_the_easy_gate_and_landed(outcome);
  EXPECT_THAT(outcome.console, Contains(HasSubstr("0 late, 0 periods overrun")));
}

TEST(ChipFlight, OneInferenceCostsLessThanThreeMillionInstructions) {
  unsigned mean = 0;
  unsigned most = 0;
  for (const auto& line : easy_flight().console) {
    std::sscanf(line.c_str(), "FC instructions per picture: mean %u, max %u", &mean, &most);
  }
  EXPECT_GT(mean, 100'000U);
  EXPECT_LE(mean, most);
  EXPECT_LT(most, 3'000'000U);
}

/// Returns the outcome of the flight with the mission's defaults on GAP8's own devices.
const Outcome& gap8_flight() {
  static const Outcome outcome = [] {
    Surroundings around;
    around.on_gap8 = true;
    return run(kMission, around, 60.0);
  }();
  return outcome;
}

TEST(ChipFlight, OnGap8sOwnDevicesItPassesTheEasyGateToo) {
  const auto& outcome = gap8_flight();
  expect_passed_the_easy_gate_and_landed(outcome);
  EXPECT_THAT(outcome.console, Contains(HasSubstr(" 0 late")));
}

class ChipFlightOn : public testing::TestWithParam<bool> {};

INSTANTIATE_TEST_SUITE_P(Boards, ChipFlightOn, testing::Bool(),
                         [](const auto& each) { return std::string(each.param ? "gap8" : "ai_deck"); });

TEST_P(ChipFlightOn, TheChipSeesInEachPictureWhatTheSameCodeSeesOnThisMachine) {
  const auto& outcome = GetParam() ? gap8_flight() : easy_flight();
  int compared = 0;
  for (const auto& line : outcome.console) {
    const auto at = line.find("picture ");
    unsigned number = 0;
    unsigned confidence = 0;
    double distance_m = 0.0;
    double yaw = 0.0;
    if (at == std::string::npos || line.find("gate at") == std::string::npos) continue;
    ASSERT_EQ(std::sscanf(line.c_str() + at, "picture %u, %*[a-z], gate at %lf m, output %lf, confidence %u", &number,
                          &distance_m, &yaw, &confidence),
              4)
        << line;
    ASSERT_LE(number, outcome.answers.size());
    const auto& answer = outcome.answers[number - 1];
    EXPECT_EQ(std::lround(1000.0 * distance_m), answer.distance_mm) << line;
    EXPECT_EQ(std::lround(1000.0 * yaw), answer.yaw * 1000 / 127) << line;
    EXPECT_EQ(confidence, answer.confidence) << line;
    ++compared;
  }
  EXPECT_GE(compared, 8);
}

TEST(ChipFlight, TwoRunsPrintTheSameAndEndInTheSamePlace) {
  const auto second = run(kMission, {}, 60.0);
  EXPECT_EQ(easy_flight().console, second.console);
  EXPECT_EQ(easy_flight().last.p_WB_m, second.last.p_WB_m);
  EXPECT_EQ(easy_flight().instructions, second.instructions);
}

TEST(ChipFlight, FirmwareLandsAtTheLandingChargeWithoutAGateToPass) {
  Surroundings around;
  around.with_gate = false;
  around.charge = 0.12;
  around.charge_per_second = 0.002;
  const auto outcome = run(kMission, around, 40.0);
  ASSERT_TRUE(outcome.ended) << outcome.fault;
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.phase, kLanded);
  EXPECT_THAT(outcome.console, Contains(HasSubstr("charge 0.100: time to land")));
}

TEST(ChipFlight, FirmwareStaysOnTheGroundAtTheLandingCharge) {
  Surroundings around;
  around.charge = 0.1;
  const auto outcome = run(kMission, around, 2.0);
  ASSERT_TRUE(outcome.ended) << outcome.fault;
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_EQ(outcome.phase, kOnGround);
}

TEST(ChipFlight, FirmwareEndsWithTwoWhenTheDroneCrashes) {
  for (const double crash_at_s : {1.0, 10.0}) {  // climbing, flying
    SCOPED_TRACE(crash_at_s);
    Surroundings around;
    around.crash_at_s = crash_at_s;
    const auto outcome = run(kMission, around, 20.0);
    ASSERT_TRUE(outcome.ended) << outcome.fault;
    EXPECT_EQ(outcome.exit_code, 2);
  }
}

TEST(ChipFlight, FirmwareLandsWhenThePictureDoesNotFitItsBuffer) {
  Surroundings around;
  around.picture_edge_px = 400;
  const auto outcome = run(kMission, around, 20.0);
  ASSERT_TRUE(outcome.ended) << outcome.fault;
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_EQ(outcome.phase, kLanded);
}

TEST(ChipFlight, FirmwareHoversAndCountsWhenNoPictureComes) {
  Surroundings around;
  around.with_pictures = false;
  around.charge = 0.12;
  around.charge_per_second = 0.002;
  const auto outcome = run(kMission, around, 40.0);
  ASSERT_TRUE(outcome.ended) << outcome.fault;
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.console, Contains(HasSubstr("0 pictures, 0 with a gate")));
}

TEST(ChipFlight, APictureIsExposedWhileTheOneBeforeIsLookedAt) {
  // Exposure, read-out and the latency of the request take 18 ms, and an inference takes 25 to 33 ms. In sequence, they
  // would take longer than the period of 35 ms.
  auto mission = kMission;
  mission.frame_period_s = 0.035;
  const auto outcome = run(mission, {}, 60.0);
  ASSERT_TRUE(outcome.ended) << outcome.fault;
  EXPECT_EQ(outcome.exit_code, 0);
  unsigned pictures = 0;
  unsigned overruns = 0;
  unsigned overlapped = 0;
  for (const auto& line : outcome.console) {
    std::sscanf(line.c_str(),
                "gate crossed, ended after %*[0-9.] s: %u pictures, %*u with a gate, %*u late, %u periods", &pictures,
                &overruns);
    std::sscanf(line.c_str(), "vision took %*[0-9.] ms at most; %u pictures", &overlapped);
  }
  EXPECT_LE(overruns, 1U) << "at most for the first look, of which nobody knew how long it takes";
  EXPECT_GE(overlapped, pictures / 2) << "those whose look is longer than 17 ms; near the gate none is";
  EXPECT_GT(pictures, 550U) << "20 s of flight";
}

TEST(ChipFlight, TheClockIsLowWhileTheCoreSleeps) {
  auto mission = kMission;
  mission.sleep_clock_hz = 100e6;
  const auto always = run(mission, {}, 60.0);
  ASSERT_TRUE(always.ended) << always.fault;
  const auto& lowered = easy_flight();
  EXPECT_EQ(always.exit_code, 0);
  EXPECT_NEAR(always.crossing.lateral_m, lowered.crossing.lateral_m, 0.005);
  // The clock tree's power is proportional to the clock, and the core sleeps more than two thirds of the flight.
  const double high_j = always.energy[soc::Part::fc_background];
  const double low_j = lowered.energy[soc::Part::fc_background];
  std::printf("[ measured ] clock tree %.1f mJ with the clock lowered, %.1f mJ without\n", 1e3 * low_j, 1e3 * high_j);
  EXPECT_LT(low_j, 0.45 * high_j);
  // The lower clock does not change the energy of the executed instructions.
  EXPECT_NEAR(lowered.energy.core_active_j(), always.energy.core_active_j(), 0.02 * always.energy.core_active_j());
}

TEST(ChipFlight, AdaptivePolicyPassesTheEasyGateToo) {
  auto mission = kMission;
  mission.policy = 1;
  const auto outcome = run(mission, {}, 60.0);
  ASSERT_TRUE(outcome.ended) << outcome.fault;
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(outcome.crossing.clear_of(load_scene("gate_easy").gates[0]));
}

}  // namespace
}  // namespace mebots::firmware_test
