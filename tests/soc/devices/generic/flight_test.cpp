// SPDX-License-Identifier: Apache-2.0
//
// Tests the devices of the flight controller. Expected values are computed from data sheets, clocks and ISO 2533.
#include "soc/soc.hpp"

#include "assembler.hpp"
#include "mebots/error.hpp"
#include "mebots/state/save.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace mebots::soc::test {
namespace {

constexpr Picoseconds kUs = 1'000'000;
constexpr Picoseconds kMs = 1'000 * kUs;

BoardDescription board() {
  return read_board(MEBOTS_SOURCE_DIR "/configs/boards/flight_controller.json");
}

/// The board with a program that only sleeps, because the tests access the devices themselves.
class FlightBoard {
 public:
  explicit FlightBoard(const BoardDescription& description = board())
      : soc_(description, gap8(), {}, assemble("_start: wfi\nj _start\n", 0x1C000000),
             {{}, [this](std::string_view text) { faults.emplace_back(text); }, {}}) {}

  Device& device(std::string_view name) { return *soc_.devices().find(name); }

  std::vector<std::string> faults;

 private:
  Soc soc_;
};

class FlightDevice : public testing::Test {
 protected:
  void store(std::uint32_t offset, std::uint32_t value, Picoseconds now = 0) {
    EXPECT_TRUE(device().store(offset, now, value)) << offset;
  }
  std::uint32_t load(std::uint32_t offset, Picoseconds now = 0) {
    std::uint32_t value = 0;
    EXPECT_TRUE(device().load(offset, now, value)) << offset;
    return value;
  }
  /// Runs the device's events up to `time`, as the chip does.
  void run_to(Picoseconds time) {
    while (device().next_event() <= time) device().advance(device().next_event());
  }
  virtual Device& device() = 0;

  FlightBoard board_;
};

class ImuTest : public FlightDevice {
 protected:
  static constexpr std::uint32_t kControl = 0x00, kPeriod = 0x04, kThreshold = 0x08, kStatus = 0x0c, kTime = 0x10,
                                 kAccelerationX = 0x14, kAccelerationZ = 0x1c, kRateX = 0x20, kNext = 0x2c;
  static constexpr Picoseconds kDelay = 100 * kUs;  // of the board file

  Device& device() override { return board_.device("imu"); }
  std::int32_t axis(std::uint32_t offset) { return static_cast<std::int32_t>(load(offset)); }
  /// If `shakes`, the acceleration changes with each step, as if the sensor had noise.
  void run_steps(int count, Picoseconds step, bool shakes) {
    for (int i = 0; i < count; ++i) {
      if (shakes) *device().input("imu.acceleration.z") = 9.8 + 0.01 * (i % 2);
      device().begin_step(i * step);
      run_to((i + 1) * step);
    }
  }
};

TEST_F(ImuTest, SamplesAtMultiplesOfThePeriodEnterTheFifoAfterTheDelay) {
  store(kControl, 1, 300 * kUs);
  EXPECT_EQ(device().next_event(), kMs + kDelay);
  run_to(3 * kMs + kDelay - 1);
  EXPECT_EQ(load(kStatus), 2U);
  run_to(3 * kMs + kDelay);
  EXPECT_EQ(load(kStatus), 3U);
  EXPECT_EQ(load(kTime), 1000U) << "the oldest first";
  store(kNext, 1);
  EXPECT_EQ(load(kTime), 2000U);
}

TEST_F(ImuTest, CountsAreThoseOfTheFullScaleAndSaturate) {
  *device().input("imu.acceleration.x") = 9.80665;                           // 1 g of 24
  *device().input("imu.acceleration.z") = -30 * 9.80665;                     // beyond
  *device().input("imu.angular_velocity.x") = -std::acos(-1.0) / 180 * 500;  // 500 degrees/s of 2000
  store(kControl, 1);
  run_to(kMs + kDelay);
  EXPECT_EQ(axis(kAccelerationX), 1365);
  EXPECT_EQ(axis(kAccelerationZ), -32768);
  EXPECT_EQ(axis(kRateX), -8192);
}

TEST_F(ImuTest, AFullFifoKeepsItsSamplesAndReportsTheLoss) {
  store(kControl, 1);
  run_to(32 * kMs + kDelay);
  EXPECT_EQ(load(kStatus), 32U);
  run_to(33 * kMs + kDelay);
  EXPECT_EQ(load(kStatus), 32U | 1U << 8);
  EXPECT_EQ(load(kTime), 1000U);
  store(kStatus, 1U << 8);
  EXPECT_EQ(load(kStatus), 32U);
}

TEST_F(ImuTest, TheInterruptIsUpWhileTheFifoHasAsManySamplesAsTheThreshold) {
  store(kThreshold, 2);
  store(kControl, 1);
  run_to(kMs + kDelay);
  EXPECT_FALSE(device().interrupt());
  run_to(2 * kMs + kDelay);
  EXPECT_TRUE(device().interrupt());
  store(kNext, 1);
  EXPECT_FALSE(device().interrupt());
  store(kThreshold, 0);
  run_to(9 * kMs);
  EXPECT_FALSE(device().interrupt()) << "0 = no interrupt";
}

TEST_F(ImuTest, ReportsOnceThatSamplesRepeatWithinSteps) {
  store(kControl, 1);
  run_steps(40, 10 * kMs, true);
  EXPECT_THAT(board_.faults,
              testing::ElementsAre(testing::AllOf(
                  testing::HasSubstr("the 10 samples of imu within a communication step of 0.01 s have one value"),
                  testing::HasSubstr("Set the config's \"step\" to the sample period, 0.001 s, or less"))));
}

TEST_F(ImuTest, DoesNotReportOneSamplePerStepOrConstantInputs) {
  store(kControl, 1);
  run_steps(40, kMs, true);
  run_steps(40, 10 * kMs, false);
  EXPECT_THAT(board_.faults, testing::IsEmpty());
}

TEST_F(ImuTest, RefusesPeriodsThatTheSensorLacks) {
  store(kPeriod, 499);
  EXPECT_EQ(load(kPeriod), 1000U);
  EXPECT_EQ(load(kStatus), 1U << 9);
  store(kPeriod, 2000);
  EXPECT_EQ(load(kPeriod), 2000U);
}

TEST_F(ImuTest, ConsumesTheCurrentOfItsStates) {
  store(kControl, 1, 0);
  store(kControl, 0, 4 * kMs);
  EXPECT_NEAR(device().energy_j(10 * kMs), 3.0 * (5.15e-3 * 4e-3 + 0.005e-3 * 6e-3), 1e-15);
}

class PwmTest : public FlightDevice {
 protected:
  static constexpr std::uint32_t kControl = 0x0, kPeriod = 0x4, kStatus = 0x8, kDuty1 = 0xc, kDuty4 = 0x18;
  /// The length of a PWM period is 256 ticks of 84 MHz, rounded up to picoseconds.
  static constexpr Picoseconds kLength = 3'047'620;

  Device& device() override { return board_.device("rotors"); }
  double command(std::uint32_t number) { return *device().output("rotor[" + std::to_string(number) + "].command"); }
};

TEST_F(PwmTest, AnOutputTakesANewDutyAtTheStartOfAPeriod) {
  store(kDuty1, 64, 0);
  EXPECT_EQ(command(1), 0.0) << "off";
  store(kControl, 1, 1000);
  EXPECT_EQ(command(1), 0.25);
  EXPECT_EQ(device().next_event(), kNever) << "nothing waits";
  store(kDuty1, 128, 1000 + kLength / 2);
  store(kDuty4, 512, 1000 + kLength / 2 + 5);
  run_to(1000 + kLength - 1);
  EXPECT_EQ(command(1), 0.25);
  run_to(1000 + kLength);
  EXPECT_EQ(command(1), 0.5);
  EXPECT_EQ(command(4), 1.0) << "more than the period is always";
  store(kControl, 0, 2 * kLength);
  EXPECT_EQ(command(1), 0.0) << "at once";
}

TEST_F(PwmTest, RefusesAPeriodOfZero) {
  store(kPeriod, 0);
  EXPECT_EQ(load(kPeriod), 256U);
  EXPECT_EQ(load(kStatus), 1U);
  store(kStatus, 1);
  EXPECT_EQ(load(kStatus), 0U);
}

class BarometerTest : public FlightDevice {
 protected:
  static constexpr std::uint32_t kControl = 0x0, kStatus = 0x4, kPressure = 0x8;
  static constexpr Picoseconds kTime = 40 * kMs;  // of a measurement, in the board file

  Device& device() override { return board_.device("barometer"); }
  double pressure_pa(double altitude_m) {
    *device().input("barometer.altitude") = altitude_m;
    run_to(device().next_event());
    return 0.01 * load(kPressure);
  }
};

TEST_F(BarometerTest, MeasuresTheStandardAtmosphere) {
  store(kControl, 1);
  // Pressures at geopotential altitudes, from ISO 2533 and the U.S. Standard Atmosphere 1976.
  EXPECT_NEAR(pressure_pa(0), 101325, 0.01);
  EXPECT_NEAR(pressure_pa(500), 95461, 0.6);
  EXPECT_NEAR(pressure_pa(1000), 89874.6, 0.1);
  EXPECT_NEAR(pressure_pa(3000), 70108.5, 0.3);
  *device().input("barometer.ground_altitude") = 1000;
  EXPECT_NEAR(pressure_pa(-1000), 101325, 0.01);
}

TEST_F(BarometerTest, AMeasurementTakesItsTimeAndSetsTheStatus) {
  store(kControl, 1, 5 * kMs);
  run_to(5 * kMs + kTime - 1);
  EXPECT_EQ(load(kStatus), 0U);
  run_to(5 * kMs + kTime);
  EXPECT_EQ(load(kStatus), 1U);
  store(kStatus, 1);
  EXPECT_EQ(load(kStatus), 0U);
  store(kControl, 0, 6 * kMs + kTime);
  EXPECT_EQ(device().next_event(), kNever);
}

TEST_F(BarometerTest, NoiseHasItsStandardDeviationAndDependsOnTheSeed) {
  *device().input("barometer.noise") = 2;
  store(kControl, 1);
  constexpr int kCount = 4000;
  double sum = 0;
  double squares = 0;
  for (int i = 0; i < kCount; ++i) {
    const double error = pressure_pa(0) - 101325;
    sum += error;
    squares += error * error;
  }
  // The tolerances are four standard errors of the mean and of the standard deviation.
  EXPECT_NEAR(sum / kCount, 0, 4 * 2 / std::sqrt(kCount));
  EXPECT_NEAR(std::sqrt(squares / kCount), 2, 4 * 2 / std::sqrt(2.0 * kCount));

  const auto first_pressure = [](double seed) {
    FlightBoard fresh;
    auto& barometer = fresh.device("barometer");
    *barometer.input("barometer.noise") = 2;
    *barometer.input("barometer.seed") = seed;
    barometer.store(kControl, 0, 1);
    barometer.advance(kTime);
    std::uint32_t pressure = 0;
    barometer.load(kPressure, kTime, pressure);
    return pressure;
  };
  EXPECT_NE(first_pressure(1), first_pressure(2));
}

/// If a measurement took no time, the device would measure forever, and time would not advance.
TEST(BarometerBoard, IsRefusedWithoutATimeOfAMeasurement) {
  for (const double delay_s : {0.0, 1e-13, 0.99e-6}) {
    auto changed = board();
    const auto entry = std::ranges::find(changed.devices, "barometer", &BoardDevice::name);
    ASSERT_NE(entry, changed.devices.end());
    const auto active = std::ranges::find(entry->states, "active", &BoardState::name);
    ASSERT_NE(active, entry->states.end());
    active->delay_s = delay_s;
    try {
      const FlightBoard refused(changed);
      ADD_FAILURE() << delay_s;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("device barometer: the delay ")) << delay_s;
      EXPECT_THAT(error.what(), testing::HasSubstr("must be at least 1e-06 s"));
    }
  }
}

/// The flight controller on the bench: the drone stands, and the set-point is a take-off.
class Bench {
 public:
  Bench()
      : soc(board(), gap8(), {}, Elf::read(MEBOTS_FLIGHT_PID),
            {[this](std::string_view line) { console.emplace_back(line); },
             [this](std::string_view text) { faults.emplace_back(text); },
             {}}) {
    *input("commander", "setpoint.mode") = 1;
    *input("commander", "setpoint.altitude") = 1;
    *input("deck", "deck.range") = 0.015;
  }

  double* input(std::string_view device, std::string_view variable) {
    return soc.devices().find(device)->input(variable);
  }
  void run_to(std::int64_t ms) {
    for (; done_ms < ms; ++done_ms) {
      soc.begin_step();
      soc.advance((done_ms + 1) * 1'000'000);
    }
  }
  double command(int number) const { return *soc.devices().output("rotor[" + std::to_string(number) + "].command"); }

  std::vector<std::string> console;
  std::vector<std::string> faults;
  std::int64_t done_ms = 0;
  Soc soc;
};

TEST(FlightController, PullsUpARearAndRightSideThatSinks) {
  Bench bench;
  bench.run_to(300);
  EXPECT_GT(bench.command(1), 0.3) << "the motors run";
  *bench.input("imu", "imu.angular_velocity.x") = 0.5;   // right side down
  *bench.input("imu", "imu.angular_velocity.y") = -0.5;  // nose up
  bench.run_to(320);
  // Rotors: front right, rear right, rear left, front left.
  EXPECT_GT(bench.command(2), bench.command(1));
  EXPECT_GT(bench.command(2), bench.command(3));
  EXPECT_GT(bench.command(1), bench.command(4));
  EXPECT_THAT(bench.faults, testing::IsEmpty());
  EXPECT_THAT(bench.console, testing::IsEmpty()) << "no loop is late";
}

TEST(FlightController, ARestoredStateContinuesWithTheSameBits) {
  Bench straight;
  straight.run_to(150);
  const auto saved = state::save(straight.soc);
  straight.run_to(300);

  Bench restored;
  restored.run_to(20);
  state::restore(restored.soc, saved);
  restored.done_ms = 150;
  restored.run_to(300);
  EXPECT_EQ(state::save(straight.soc), state::save(restored.soc));
}

}  // namespace
}  // namespace mebots::soc::test
