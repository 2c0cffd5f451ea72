// SPDX-License-Identifier: Apache-2.0
// Tests clocks in model exchange with tests/fmus/sampler.cpp, an integrator with clocks of all kinds. The FMU rejects
// calls that FMI 3.0 does not permit at that time. Expected values follow from x' = slope + drive.
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <memory>
#include <string>

namespace mebots::master {
namespace {

using test::TestRun;
using testing::HasSubstr;

std::string sampler(const std::string& name, const std::string& parameters = "", const std::string& more = "") {
  return fmt::format(R"("{}": {{"fmu": "{}", "parameters": {{{}}}{}}})", name, SAMPLER_FMU, parameters, more);
}

std::string samplers(const std::string& instances, const std::string& connections = "") {
  return fmt::format(R"({{"step": 0.25, "stop_time": 1, "instances": {{{}}}, "connections": [{}]}})", instances,
                     connections);
}

/// Returns a config in which `plant` starts at 1. `controller` measures it every 0.1 s and drives it with -2 x until
/// the next sample.
std::string control_loop(const std::string& more = "") {
  return samplers(
      sampler("plant", R"("x": 1)", more) + ", " + sampler("controller", "", more),
      R"({"from": "plant.x", "to": "controller.measured"}, {"from": "controller.control", "to": "plant.drive"})");
}

/// Returns a config in which `a` rises with slope 1. `b` receives the times at which `a` crosses 0.3, 0.6 and 0.9.
std::string crossings(const std::string& more = "", const std::string& parameters = "") {
  return samplers(sampler("a", R"("slope": 1)" + parameters, more) + ", " + sampler("b", "", more),
                  R"({"from": "a.crossed", "to": "b.tap"}, {"from": "a.crossing_time", "to": "b.heard"})");
}

TEST(ExchangeClocks, PeriodicClocksSampleBetweenCommunicationPoints) {
  TestRun run(control_loop());
  run.to_end();
  // x is linear between samples. Each period of 0.1 s multiplies x by 1 - 2 * 0.1. The last sample is the ninth after
  // the first one.
  const auto x = run.column("plant.x");
  ASSERT_EQ(x.size(), 5U);
  EXPECT_NEAR(x[1], 0.8 * (1 - 2 * 0.05), 1e-9);
  EXPECT_NEAR(x[4], std::pow(0.8, 9), 1e-9);
  EXPECT_NEAR(run.column("controller.control").back(), -2 * std::pow(0.8, 9), 1e-9);
}

TEST(ExchangeClocks, TicksAndValuesPassOnAtStateEvents) {
  TestRun run(crossings());
  run.to_end();
  ASSERT_EQ(run.system.continuous_systems.size(), 1U);
  EXPECT_NEAR(run.column("b.sum").back(), 0.3 + 0.6 + 0.9, 1e-8);
  EXPECT_NEAR(run.column("a.crossing_time").back(), 0.9, 1e-8);
}

TEST(ExchangeClocks, CountdownsTickAfterTheirInterval) {
  TestRun run(crossings());
  const auto times = run.to_end().column("a.echo_time");
  EXPECT_NEAR(times[2], 0.32, 1e-8);  // value at 0.5 s
  EXPECT_NEAR(times[4], 0.92, 1e-8);
}

TEST(ExchangeClocks, AClockMayFollowAPeriodicInputClock) {
  TestRun run(samplers(sampler("a", R"("measured": 1)") + ", " + sampler("b"),
                       R"({"from": "a.sample", "to": "b.tap"}, {"from": "a.control", "to": "b.heard"})"));
  EXPECT_EQ(run.to_end().column("b.sum").back(), -20);  // ten samples of -2
}

TEST(ExchangeClocks, HaveTheSameBitsInAProcessOfTheirOwn) {
  for (const auto& [config, name] :
       {std::pair{&control_loop, "plant.x"}, {+[](const std::string& more) { return crossings(more); }, "b.sum"}}) {
    TestRun here(config(""));
    TestRun there(config(R"(, "process": "own")"));
    EXPECT_EQ(there.to_end().column(name), here.to_end().column(name));
  }
}

/// Runs a config and returns the last value of `name`. After each point, continues from the saved state in a new run.
double end_with_stops(const std::string& config, const char* name) {
  auto run = std::make_unique<TestRun>(config);
  run->initialize();
  while (!run->simulation().ended()) {
    run->simulation().step();
    if (run->simulation().ended()) break;
    const auto bytes = run->simulation().serialize(run->simulation().save_state());
    run = std::make_unique<TestRun>(config);
    run->simulation().resume(bytes);
  }
  return run->column(name).back();
}

TEST(ExchangeClocks, ContinueWithTheSameBitsFromASavedState) {
  EXPECT_EQ(end_with_stops(control_loop(), "plant.x"), TestRun(control_loop()).to_end().column("plant.x").back());
  EXPECT_EQ(end_with_stops(crossings(), "b.sum"), TestRun(crossings()).to_end().column("b.sum").back());
  EXPECT_EQ(end_with_stops(crossings(), "a.echo_time"), TestRun(crossings()).to_end().column("a.echo_time").back());
}

TEST(ExchangeClocks, TicksWithoutEndAreReported) {
  TestRun run(crossings("", R"(, "endless": true)"));
  try {
    run.to_end();
    FAIL() << "the echo of 0.32 s ticks without end";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("the event does not end"));
    EXPECT_THAT(error.what(), HasSubstr("request another update: 'a'"));
  }
}

TEST(ExchangeClocks, DoNotPassToCoSimulation) {
  const auto metronome = fmt::format(R"("m": {{"fmu": "{}"}})", METRONOME_FMU);
  EXPECT_THAT(test::input_error([&] {
                TestRun run(samplers(sampler("a") + ", " + metronome, R"({"from": "a.crossed", "to": "m.tap"})"));
              }),
              HasSubstr("ticks do not pass between model exchange and co-simulation"));
}

}  // namespace
}  // namespace mebots::master
