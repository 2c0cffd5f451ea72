// SPDX-License-Identifier: Apache-2.0
// Tests clocks of FMI 3.0 with tests/fmus/metronome.cpp, which has periodic, countdown and triggered clocks.
#include "slave/clocked/timed_clock.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <limits>
#include <optional>
#include <string>

namespace mebots::master {
namespace {

using test::TestRun;
using testing::HasSubstr;

/// Returns a config of two metronomes. `parameters` and `more` belong to "a".
std::string metronomes(const std::string& connections = "", const std::string& parameters = "",
                       const std::string& more = "") {
  return fmt::format(R"({{"step": 0.1, "stop_time": 1, "instances": {{
    "a": {{"fmu": "{0}", "parameters": {{{2}}}{3}}}, "b": {{"fmu": "{0}"}}}}, "connections": [{1}]}})",
                     METRONOME_FMU, connections, parameters, more);
}

std::string metronomes_refused(const std::string& config) {
  return test::input_error([&] { TestRun run(config); });
}

const std::string kTapped = R"({"from": "a.tock", "to": "b.tap"}, {"from": "a.tock_time", "to": "b.heard"})";

TEST(Clocks, PeriodicClocksTickBetweenCommunicationPoints) {
  TestRun run(metronomes());
  // The periodic clock ticks at 0.15, 0.45 and 0.75.
  EXPECT_THAT(run.to_end().column("a.beats"), testing::ElementsAre(0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3));
}

TEST(Clocks, CountdownsTickAfterTheirInterval) {
  TestRun run(metronomes());
  const auto times = run.to_end().column("a.tock_time");
  EXPECT_NEAR(times[2], 0.17, 1e-12);
  EXPECT_NEAR(times[10], 0.77, 1e-12);
}

TEST(Clocks, TicksAndValuesPassOnAtOneInstant) {
  TestRun run(metronomes(kTapped));
  ASSERT_EQ(run.system.clock_groups.size(), 1U);
  EXPECT_EQ(run.system.clock_groups[0].members.size(), 2U);
  run.to_end();
  EXPECT_EQ(run.column("b.taps").back(), 3);
  EXPECT_NEAR(run.column("b.sum").back(), 0.17 + 0.47 + 0.77, 1e-12);
  EXPECT_EQ(run.column("a.taps").back(), 0);
}

TEST(Clocks, HaveTheSameBitsInAProcessOfTheirOwn) {
  TestRun here(metronomes(kTapped));
  TestRun there(metronomes(kTapped, "", R"(, "process": "own")"));
  here.to_end();
  there.to_end();
  for (const auto* name : {"a.beats", "a.tock_time", "b.taps", "b.sum"})
    EXPECT_EQ(there.column(name), here.column(name)) << name;
}

TEST(Clocks, AClockMayFollowAPeriodicInputClock) {
  TestRun run(metronomes(R"({"from": "a.beat", "to": "b.tap"})"));
  EXPECT_THAT(run.to_end().column("b.taps"), testing::ElementsAre(0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3));
}

TEST(Clocks, ValuesForATickWaitForIt) {
  TestRun run(metronomes(R"({"from": "a.beat", "to": "b.tap"}, {"from": "a.sum", "to": "b.heard"})"));
  EXPECT_EQ(run.to_end().column("b.sum").back(), 0);
}

TEST(Clocks, ASumOfClockedValuesIsRefused) {
  EXPECT_THAT(metronomes_refused(metronomes(
                  R"({"from": "a.tock", "to": "b.tap"}, {"from": "a.tock_time", "to": "b.heard", "sum": true})")),
              HasSubstr("'tock_time' and 'heard' belong to Clocks"));
}

TEST(Clocks, TicksWithoutEndAreReported) {
  TestRun run(metronomes("", R"("endless": true)"));
  try {
    run.to_end();
    FAIL() << "the echo of 0.17 s ticks without end";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("'a': the clocks of its group tick at 0.17 s without end"));
  }
}

/// An instance with a periodic clock whose shift and interval the FMU itself determines.
class ShiftedInstance final : public ClockInstance {
 public:
  explicit ShiftedInstance(double shift_s) : shift_s_(shift_s) {}
  const std::string& name() const override { return name_; }
  bool ticks(ValueReference /*clock*/) override { return false; }
  void tick(ValueReference /*clock*/) override {}
  std::optional<double> new_interval(ValueReference /*clock*/) override { return 0.5; }
  double shift(ValueReference /*clock*/) override { return shift_s_; }

 private:
  std::string name_ = "a";
  double shift_s_;
};

/// Returns the first tick of a periodic clock that starts at 2 s, or the error.
std::string first_tick(const modeldesc::ClockTiming& timing, double instances_shift_s) {
  modeldesc::Fmi3Part part;
  part.timing = timing;
  modeldesc::Variable variable;
  variable.name = "beat";
  variable.fmi3 = part;
  TimedClock clock(variable);
  ShiftedInstance instance(instances_shift_s);
  try {
    clock.start(instance, 2);
  } catch (const Error& error) {
    return error.what();
  }
  return fmt::format("{}", clock.next_s());
}

TEST(Clocks, AShiftMustBeATime) {
  modeldesc::ClockTiming timing;
  timing.interval_variability = modeldesc::IntervalVariability::fixed;
  EXPECT_EQ(first_tick(timing, 0.25), "2.25");
  EXPECT_THAT(first_tick(timing, std::numeric_limits<double>::quiet_NaN()),
              HasSubstr("instance 'a': the clock 'beat' has the shift nan s"));
  EXPECT_THAT(first_tick(timing, -0.25), HasSubstr("has the shift -0.25 s"));
  timing.interval_s = 0.5;
  timing.shift_s = std::numeric_limits<double>::infinity();
  EXPECT_THAT(first_tick(timing, 0), HasSubstr("has the shift inf s"));
}

TEST(Clocks, AreRefusedWhereTheyCannotTick) {
  EXPECT_THAT(metronomes_refused(metronomes(R"({"from": "a.tock", "to": "b.heard"})")),
              HasSubstr("'tock' is a Clock and 'heard' is not"));
  EXPECT_THAT(metronomes_refused(metronomes(R"({"from": "a.tock", "to": "b.beat"})")),
              HasSubstr("'beat' has its own timing"));
}

}  // namespace
}  // namespace mebots::master
