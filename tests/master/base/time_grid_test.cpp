// SPDX-License-Identifier: Apache-2.0
#include "base/time_grid.hpp"

#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace mebots::master {
namespace {

using test::TestRun;
using testing::HasSubstr;

/// Returns t_k in nanoseconds for a step of n / 3 ns, computed from thirds of nanoseconds as an independent reference.
std::int64_t rounded_thirds(std::int64_t thirds) {
  const auto whole = thirds >= 0 ? thirds / 3 : -((-thirds + 2) / 3);
  return whole + (thirds - 3 * whole == 2 ? 1 : 0);
}

TEST(TimeGrid, PointsOfAWholeStepAreMultiplesOfIt) {
  const TimeGrid grid(-500'000'000, {1, 500});
  EXPECT_EQ(grid.time_ns(0), -500'000'000);
  EXPECT_EQ(grid.time_ns(250), 0);
  EXPECT_EQ(grid.time_ns(1'000'000'000'000), 1'999'999'999'500'000'000);
  EXPECT_EQ(grid.time_s(2'000'000), 0.002);
  EXPECT_EQ(grid.length_s(2'000'000, 6'000'000), 0.004);
  EXPECT_TRUE(grid.has_passed(0, 2'000'000, 2'000'000));
  EXPECT_FALSE(grid.has_passed(0, 2'000'000, 2'000'001));
}

TEST(TimeGrid, PointsOfARatioAreExactAndNeverDrift) {
  const TimeGrid grid(0, {1, 60});
  EXPECT_EQ(grid.time_ns(1), 16'666'667);
  EXPECT_EQ(grid.time_ns(2), 33'333'333);
  EXPECT_EQ(grid.time_ns(60), 1'000'000'000);
  EXPECT_EQ(grid.time_ns(60'000'000'007), 1'000'000'000'116'666'667);
  for (std::int64_t k = 0; k < 1'000'000; k += 37) {
    ASSERT_EQ(grid.time_s(grid.time_ns(k)), static_cast<double>(k) / 60) << k;
    ASSERT_EQ(grid.length_s(grid.time_ns(k), grid.time_ns(k + 1)), 1.0 / 60) << k;
    ASSERT_EQ(grid.length_s(grid.time_ns(k), grid.time_ns(k + 3)), 0.05) << k;
  }
}

TEST(TimeGrid, InternalTimeRoundsTiesToEven) {
  // With a step of 12.5 ns, every second point is half-way between two nanoseconds.
  const TimeGrid grid(0, {1, 80'000'000});
  EXPECT_EQ(grid.time_ns(1), 12);
  EXPECT_EQ(grid.time_ns(2), 25);
  EXPECT_EQ(grid.time_ns(3), 38);
  EXPECT_EQ(grid.time_ns(5), 62);
  EXPECT_EQ(grid.time_s(12), 1.25e-8);
  const TimeGrid negative(-100, {1, 80'000'000});
  EXPECT_EQ(negative.time_ns(1), -88);  // exact: -87.5 ns
  EXPECT_EQ(negative.time_ns(3), -62);  // exact: -62.5 ns
}

TEST(TimeGrid, ThirdsAreRoundedAsCountedByHand) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 200'000; ++i) {
    const auto step_thirds = static_cast<std::int64_t>(random() >> (24 + random() % 30)) + 31;
    if (step_thirds % 3 == 0) continue;
    const auto start_ns = static_cast<std::int64_t>(random() >> 20) - (std::int64_t{1} << 43);
    const auto k = static_cast<std::int64_t>(random() >> 45);
    const TimeGrid grid(start_ns, reduced(step_thirds, 3 * WideInteger{kNanosecondsPerSecond}));
    ASSERT_EQ(grid.time_ns(k), rounded_thirds(3 * start_ns + k * step_thirds)) << start_ns << " " << step_thirds;
  }
}

TEST(TimeGrid, AnInternalTimeNamesOnePoint) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 100'000; ++i) {
    const auto q = static_cast<std::int64_t>(random() % 999'999'999) + 1;
    const auto p = static_cast<std::int64_t>(random() % 1000) + q / 50'000'000 + 1;
    const auto start_ns = static_cast<std::int64_t>(random() >> 3) - (std::int64_t{1} << 60);
    const TimeGrid grid(start_ns, reduced(p, q));
    const auto k = static_cast<std::int64_t>(random() % 1'000'000);
    const auto time_ns = grid.time_ns(k);
    ASSERT_LT(time_ns, grid.time_ns(k + 1));
    ASSERT_TRUE(grid.is_point(time_ns));
    ASSERT_EQ(grid.point_at(time_ns), k);
    ASSERT_EQ(grid.point_at(grid.time_ns(k + 1) - 1), k);
    ASSERT_EQ(grid.length_s(time_ns, grid.time_ns(k + 1)), to_seconds(reduced(p, q)));
  }
}

TEST(TimeGrid, TheExtremesOfTimeDoNotOverflow) {
  // The largest denominators of step and start, and the ends of the range of times.
  const std::int64_t end_ns = 9'199'999'999'999'999'999;
  const TimeGrid grid(-end_ns, {999'999'937, 999'999'999});
  const auto last = grid.point_at(0);
  EXPECT_NEAR(static_cast<double>(last), 9.2e9 * 999'999'999 / 999'999'937, 2);
  EXPECT_LE(grid.time_ns(last), 0);
  EXPECT_GT(grid.time_ns(last + 1), 0);
  EXPECT_EQ(grid.length_s(grid.time_ns(last), grid.time_ns(last + 1)), 999'999'937.0 / 999'999'999);
}

TEST(TimeGrid, ATimeBetweenThePointsIsTakenAsItIs) {
  const TimeGrid grid(0, {1, 3});
  EXPECT_FALSE(grid.is_point(100'000'000));
  EXPECT_FALSE(grid.is_point(-333'333'333));
  EXPECT_EQ(grid.time_s(100'000'000), 0.1);
  EXPECT_EQ(grid.length_s(0, 100'000'000), 0.1);
  EXPECT_EQ(grid.length_s(100'000'000, 333'333'333), 1.0 / 3 - 0.1);
}

/// Returns a config with a probe, whose outputs are the end t + h and the length h of its last step.
std::string probe_system(const std::string& times, const std::string& instance = "", const std::string& more = "") {
  return fmt::format(R"({{{}, "instances": {{"a": {{"fmu": "PROBE"{}}}}}, "connections": []{}}})", times, instance,
                     more);
}

/// Checks that the FMU received the doubles nearest to t_k and to the step, for steps of p / q seconds.
void expect_exact_steps(TestRun& run, std::int64_t p, std::int64_t q, std::size_t points) {
  const auto times = run.column("time");
  const auto ends = run.column("a.last_end");
  const auto lengths = run.column("a.last_step");
  ASSERT_EQ(times.size(), points);
  const double step_s = static_cast<double>(p) / static_cast<double>(q);
  for (std::size_t k = 0; k < points; ++k) {
    const double exact = static_cast<double>(static_cast<std::int64_t>(k) * p) / static_cast<double>(q);
    ASSERT_EQ(times[k], exact) << k;
    if (k == 0) continue;
    ASSERT_EQ(lengths[k], step_s) << k;
    ASSERT_EQ(ends[k], times[k - 1] + step_s) << k;
  }
}

TEST(RatioSteps, AnFmuReceivesTheNearestDoublesInEveryStep) {
  const auto* record = R"(, "record": ["a.last_end", "a.last_step"])";
  for (const char* process : {"shared", "own"}) {
    TestRun run(
        probe_system(R"("step": "1/60", "stop_time": 10)", fmt::format(R"(, "process": "{}")", process), record));
    run.to_end();
    expect_exact_steps(run, 1, 60, 601);
  }
  TestRun run(probe_system(R"("step": "7/11", "stop_time": 700)", "", record));
  expect_exact_steps(run.to_end(), 7, 11, 1101);
}

TEST(RatioSteps, InstancesStepOnMultiples) {
  TestRun run(R"({"step": "1/60", "stop_time": 1, "instances": {
      "a": {"fmu": "PROBE", "step": "1/20"}, "b": {"fmu": "PROBE", "step": 0.03333333333333333}}, "connections": [],
      "record": {"variables": ["a.steps", "b.steps", "a.last_step", "b.last_step"], "interval": 0.1}})");
  run.to_end();
  EXPECT_THAT(run.column("time"), testing::ElementsAre(0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1));
  EXPECT_EQ(run.column("a.steps").back(), 20);
  EXPECT_EQ(run.column("b.steps").back(), 30);
  EXPECT_EQ(run.column("a.last_step").back(), 0.05);
  EXPECT_EQ(run.column("b.last_step").back(), 1.0 / 30);
}

TEST(RatioSteps, ConditionsAndScenariosCountWholeSteps) {
  // In whole nanoseconds, two steps of 1/60 s take 33333333 or 33333334 ns, depending on where they begin.
  for (int first = 1; first <= 6; ++first) {
    TestRun run(probe_system(
        R"("step": "1/60", "stop_time": 1)", "",
        fmt::format(R"(, "stop_when": [{{"variable": "a.steps", "above": {}, "for": 0.03333333333333333}}])",
                    first - 1)));
    EXPECT_EQ(run.to_end().column("a.steps").back(), first + 2) << first;
  }
  TestRun run(probe_system(R"("step": "1/60", "stop_time": "12/60")", "", R"(, "scenario": [
      {"variable": "a.real_in", "set": 1, "from": 0.05, "duration": 0.03333333333333333}])"));
  run.to_end();
  EXPECT_NEAR(run.column("a.integral").back(), 2.0 / 60, 1e-15);
}

TEST(RatioSteps, ARunContinuesFromASavedStateWithTheSameBits) {
  const auto text = probe_system(R"("step": "3/7", "stop_time": 30)", R"(, "parameters": {"real_in": 0.7})");
  TestRun straight(text);
  straight.to_end();
  TestRun second(text);
  second.initialize();
  const auto kept = second.simulation().save_state();  // the FMUs must then keep data to return to this state
  for (int i = 0; i < 23; ++i) second.simulation().step();
  const auto bytes = second.simulation().serialize(second.simulation().save_state());
  for (int i = 0; i < 9; ++i) second.simulation().step();
  second.simulation().restore_state(second.simulation().deserialize(bytes));
  while (second.simulation().step()) {
  }
  EXPECT_EQ(second.csv(), straight.csv());
}

TEST(RatioSteps, ADiscardedStepIsTakenInPartsThatReachItsEnd) {
  TestRun run(R"({"step": "1/3", "stop_time": 1, "instances": {"a": {"fmu": "COUPLING", "on_discard": "divide",
      "parameters": {"behaviour": "short", "max_step": 0.125}}}, "connections": []})");
  run.to_end();
  EXPECT_THAT(run.column("a.steps"), testing::ElementsAre(0, 3, 6, 9));
  EXPECT_THAT(run.column("a.now"),
              testing::ElementsAre(0, testing::DoubleNear(1.0 / 3, 1e-15), testing::DoubleNear(2.0 / 3, 1e-15),
                                   testing::DoubleNear(1, 1e-15)));
}

TEST(NegativeTime, ARunStartsBeforeZero) {
  TestRun run(
      probe_system(R"("step": 0.1, "start_time": -0.4, "stop_time": 0.2)", R"(, "parameters": {"real_in": 1})"));
  EXPECT_THAT(run.to_end().column("time"), testing::ElementsAre(-0.4, -0.3, -0.2, -0.1, 0, 0.1, 0.2));
  EXPECT_THAT(run.column("a.last_end").back(), testing::DoubleNear(0.2, 1e-16));
  EXPECT_NEAR(run.column("a.integral").back(), 0.6, 1e-15);
}

TEST(NegativeTime, ARatioStartsBeforeZero) {
  TestRun run(probe_system(R"("step": "1/3", "start_time": -1.5, "stop_time": 0.5)"));
  EXPECT_THAT(run.to_end().column("time"),
              testing::ElementsAre(-1.5, -7.0 / 6, -5.0 / 6, -0.5, -1.0 / 6, 1.0 / 6, 0.5));
}

TEST(NegativeTime, ConditionsAndScenariosActBeforeZero) {
  const auto times = R"("step": 0.1, "start_time": -1, "stop_time": 1)";
  TestRun stopped(probe_system(times, "", R"(, "stop_when": [{"variable": "a.steps", "above": 2, "for": 0.2}])"));
  EXPECT_EQ(stopped.to_end().column("time").back(), -0.5);
  EXPECT_THAT(stopped.simulation().end().text, HasSubstr("at -0.7 s"));

  // Overrides from -0.5 s for 0.3 s, from the start until -0.8 s, and for 0.2 s after a condition is true.
  TestRun run(probe_system(times, "", R"(, "scenario": [
      {"variable": "a.real_in", "set": 1, "from": -0.5, "duration": 0.3},
      {"variable": "a.real_in", "set": 10, "until": -0.8},
      {"variable": "a.real_in", "set": 100, "when": {"variable": "a.steps", "equals": 9}, "duration": 0.2}])"));
  run.to_end();
  EXPECT_NEAR(run.column("a.integral").back(), 0.3 * 1 + 0.2 * 10 + 0.2 * 100, 1e-12);
  const auto report = run.scenario->report(run.system, run.simulation().time_ns());
  EXPECT_EQ(report[0]["from"], -0.5);
  EXPECT_EQ(report[1]["until"], -0.8);
  EXPECT_EQ(report[2]["from"], -0.1);
}

}  // namespace
}  // namespace mebots::master
