// SPDX-License-Identifier: Apache-2.0
// Tests step control, which adapts the step to the coupling error, with FMUs that integrate exactly.
#include "run/run.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace mebots::master {
namespace {

using test::TestRun;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

struct Settings {
  std::string control = R"({"max_step": 0.1})";
  std::string of_a = {};  ///< further keys of the instance
  std::string of_b = {};
  std::string of_record = {};
  std::string more = {};  ///< further keys of the config
  std::string step = "0.0001";
  int seconds = 5;
};

/// Returns a config of two masses with a spring between them (tests/fmus/coupling.c). Their inputs are constant during
/// a step.
std::string masses(const Settings& settings) {
  static const test::ChangedFmu held("coupling", R"(canInterpolateInputs="true" maxOutputDerivativeOrder="2")", "");
  return fmt::format(R"({{"step": {0}, "stop_time": {1}{2}, {3} "instances": {{
      "a": {{"fmu": "{4}", "parameters": {{"mass_x": 1}} {5}}}, "b": {{"fmu": "{4}" {6}}}}},
    "connections": [{{"from": "a.mass_x", "to": "b.mass_u"}}, {{"from": "b.mass_x", "to": "a.mass_u"}}],
    "record": {{"variables": ["*.mass_x", "*.mass_v"] {7}}}}})",
                     settings.step, settings.seconds,
                     settings.control.empty() ? "" : ", \"step_control\": " + settings.control, settings.more,
                     held.path().string(), settings.of_a, settings.of_b, settings.of_record);
}

/// Returns the root mean square of the error of a.mass_x over time.
double error_of(TestRun& run) {
  const auto times = run.column("time");
  const auto values = run.column("a.mass_x");
  double squares = 0;
  for (std::size_t i = 1; i < times.size(); ++i) {
    const double t = times[i];
    const double exact = (std::cos(std::sqrt(10) * t) + std::cos(std::sqrt(30) * t)) / 2;
    squares += (values[i] - exact) * (values[i] - exact) * (t - times[i - 1]);
  }
  return std::sqrt(squares / times.back());
}

std::string refusal(const Settings& settings) {
  return test::input_error([&] { TestRun run(masses(settings)); });
}

TEST(StepControl, TheErrorFallsWithTheTolerance) {
  // With constant inputs, the integral of the deviation over a step is proportional to h^2. A tolerance 100 times
  // smaller makes steps and error 10 times smaller.
  double before = 0;
  for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
    TestRun run(masses({.control = fmt::format(R"({{"max_step": 0.1, "relative_tolerance": {},
      "absolute_tolerance": 1e-12}})",
                                               tolerance),
                        .step = "0.000001"}));
    const double error = error_of(run.to_end());
    if (before > 0) {
      EXPECT_NEAR(before / error, 10, 2.5) << tolerance;
    } else {
      EXPECT_LT(error, 0.2);
    }
    before = error;
  }
}

TEST(StepControl, TimeIsExact) {
  Settings settings{.of_record = R"(, "step": true)", .step = R"("1/3000")"};
  TestRun run(masses(settings));
  const auto times = run.to_end().column("time");
  const auto steps = run.column("step");
  EXPECT_EQ(times.back(), 5);
  EXPECT_EQ(steps.front(), 0);
  for (std::size_t i = 1; i < times.size(); ++i) {
    const double point = std::round(times[i] * 3000);
    EXPECT_EQ(times[i], point / 3000) << "a double nearest to k / 3000, never a sum";
    EXPECT_NEAR(steps[i], times[i] - times[i - 1], 1e-15);
  }
  EXPECT_GT(*std::ranges::max_element(steps), 3 / 3000.);
}

TEST(StepControl, StatisticsCountWhatHappened) {
  TestRun run(masses({.of_record = R"(, "step": true)"}));
  auto steps = run.to_end().column("step");
  steps.erase(steps.begin());
  const auto& statistics = *run.simulation().step_statistics();
  EXPECT_EQ(statistics.steps, static_cast<std::int64_t>(steps.size()));
  EXPECT_EQ(run.simulation().steps_done(), statistics.steps);
  EXPECT_EQ(run.simulation().grid_point(), 50'000);
  EXPECT_NEAR(static_cast<double>(statistics.smallest) * 1e-4, *std::ranges::min_element(steps), 1e-15);
  EXPECT_NEAR(static_cast<double>(statistics.largest) * 1e-4, *std::ranges::max_element(steps), 1e-15);
  EXPECT_EQ(statistics.worst[0] + statistics.worst[1], statistics.steps) << "both sources move in every step";
  EXPECT_EQ(statistics.rejected, 0);
}

TEST(StepControl, NeedsFewerStepsThanAFixedStepWhenTheSystemComesToRest) {
  // Two bodies with a damper between them (tests/fmus/oscillator.c). The transient ends after the first of 20 s.
  static const test::ChangedFmu held("oscillator", R"(canInterpolateInputs="true" maxOutputDerivativeOrder="1")", "");
  const auto config = [](const std::string& step, const std::string& control) {
    return fmt::format(R"({{"step": {0}, "stop_time": 20 {2}, "instances": {{
        "a": {{"fmu": "{1}", "parameters": {{"stiffness": 0, "x": 1}}}},
        "b": {{"fmu": "{1}", "parameters": {{"stiffness": 1000, "grip": 50, "damping": 10, "y": 1}}}}}},
      "connections": [{{"from": "a.velocity", "to": "b.other_velocity"}}, {{"from": "b.pull", "to": "a.force"}}],
      "record": ["a.x"]}})",
                       step, held.path().string(), control);
  };
  TestRun exact(config("0.00001", ""));
  const auto reference = exact.to_end().column("a.x");
  // Returns the largest error of a.x compared with a run whose steps are 1e-5 s.
  const auto error = [&](TestRun& run) {
    const auto times = run.column("time");
    const auto values = run.column("a.x");
    double largest = 0;
    for (std::size_t i = 0; i < times.size(); ++i) {
      const auto k = static_cast<std::size_t>(std::llround(times[i] * 1e5));
      largest = std::max(largest, std::abs(values[i] - reference[k]));
    }
    return largest;
  };
  TestRun controlled(config("0.00001", R"(, "step_control": {"max_step": 0.1, "relative_tolerance": 1e-4})"));
  const double error_controlled = error(controlled.to_end());
  TestRun fixed(config("0.005", ""));
  const double error_fixed = error(fixed.to_end());
  EXPECT_LT(error_controlled, error_fixed);
  EXPECT_LT(2 * controlled.simulation().steps_done(), fixed.simulation().steps_done());
}

TEST(StepControl, ABondMakesTheEnergyThatIsReported) {
  // The energy of a and b together increases by the energy that the coupling creates, also for steps of different
  // lengths (see BondEnergy.IsWhatBothHalvesTogetherGained).
  static const test::ChangedFmu held("oscillator", R"(canInterpolateInputs="true" maxOutputDerivativeOrder="1")", "");
  const modeldesc::TemporaryFolder folder("mebots-test");
  test::write_file(folder.path() / "test.json", fmt::format(R"({{"step": 0.0001, "stop_time": 5, "instances": {{
      "a": {{"fmu": "{0}", "parameters": {{"x": 1}}}}, "b": {{"fmu": "{0}", "parameters": {{"grip": 10, "y": 1}}}}}},
    "connections": [{{"from": "a.velocity", "to": "b.other_velocity"}}, {{"from": "b.pull", "to": "a.force"}}],
    "coupling": {{"bonds": {{"spring": {{"effort": "a.force", "flow": "b.other_velocity"}}}}}},
    "step_control": {{"max_step": 0.05, "initial_step": 0.01, "relative_tolerance": 1e-3,
                      "tolerances": {{"a.force": false, "b.other_velocity": false}}}},
    "summary": {{"energy a": "a.energy", "energy b": "b.energy"}}}})",
                                                            held.path().string()));
  master::Run run(folder.path() / "test.json");
  run.run();
  const auto summary = run.summary();
  const double gained = summary["energy a"].get<double>() + summary["energy b"].get<double>() - 10;
  EXPECT_NEAR(summary["coupling"]["bonds"]["spring"]["made"].get<double>(), gained, 0.05 * std::abs(gained));
  const auto& control = summary["step_control"];
  EXPECT_EQ(control["largest_error_in"].size(), 1U) << "the bond alone, not its inputs";
  EXPECT_EQ(control["largest_error_in"]["spring"], summary["steps"]);
  EXPECT_LT(control["smallest_step"].get<double>(), 0.5 * control["largest_step"].get<double>());
  EXPECT_EQ(control["rolls_back"], false);
}

TEST(StepControl, NoStepPassesAForcedPoint) {
  const std::string scenario =
      R"("scenario": [{"variable": "a.ramp_in", "set": 1, "from": 1.2345, "until": 2.3456},
                      {"variable": "b.ramp_in", "offset": 1, "when": {"variable": "a.mass_x", "below": 0},
                       "duration": 0.7531}],)";
  TestRun run(masses({.more = scenario}));
  const auto times = run.to_end().column("time");
  EXPECT_THAT(times, AllOf(Contains(1.2345), Contains(2.3456)));
  // The condition is true from the first point at which a.mass_x is below 0. Its override ends 0.7531 s later.
  const auto places = run.column("a.mass_x");
  const auto first = std::ranges::find_if(places, [](double x) { return x < 0; }) - places.begin();
  EXPECT_THAT(times, Contains(testing::DoubleNear(times[static_cast<std::size_t>(first)] + 0.7531, 1e-12)));
}

TEST(StepControl, AnEventRestartsWithTheInitialStep) {
  TestRun run(masses({.control = R"({"max_step": 0.1, "relative_tolerance": 1e-2, "initial_step": 0.0003})",
                      .of_record = R"(, "step": true)",
                      .more = R"("scenario": [{"variable": "a.ramp_in", "set": 1, "from": 2.5}],)"}));
  const auto times = run.to_end().column("time");
  const auto steps = run.column("step");
  const auto event = static_cast<std::size_t>(std::ranges::find(times, 2.5) - times.begin());
  ASSERT_LT(event + 1, times.size());
  EXPECT_NEAR(steps[event + 1], 0.0003, 1e-15);
  EXPECT_GT(steps[event - 1], 0.003);
}

TEST(StepControl, TheIntervalOfTheRecordIsKept) {
  TestRun run(masses({.of_record = R"(, "interval": 0.25)"}));
  const auto times = run.to_end().column("time");
  ASSERT_EQ(times.size(), 21U);
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_EQ(times[i], 0.25 * static_cast<double>(i));
  EXPECT_GT(run.simulation().steps_done(), 21);
}

TEST(StepControl, AnInstanceWithAStepOfItsOwnKeepsIt) {
  Settings settings{.control = R"({"max_step": 0.1, "relative_tolerance": 0.1})", .of_b = R"(, "step": 0.04)"};
  TestRun run(masses(settings));
  const auto times = run.to_end().column("time");
  for (int i = 0; i <= 125; ++i) EXPECT_THAT(times, Contains(testing::DoubleNear(0.04 * i, 1e-12))) << i;
  // The outputs of the instance with the longer step do not change between its own communication points.
  const auto values = run.column("b.mass_x");
  for (std::size_t i = 1; i < times.size(); ++i) {
    const bool on_grid = std::abs(std::remainder(times[i], 0.04)) < 1e-9;
    EXPECT_TRUE(on_grid || values[i] == values[i - 1]) << times[i];
  }
}

TEST(StepControl, RowsOfSignalsAreForcedPoints) {
  Settings settings{.more = R"("inputs": {"file": "signal.csv"},)"};
  const modeldesc::TemporaryFolder folder("mebots-test");
  test::write_file(folder.path() / "signal.csv", "time,a.ramp_in\n0,0\n0.3333,1\n1.7,2\n4.9,0\n");
  test::write_file(folder.path() / "test.json", masses(settings));
  RunOptions options;
  options.in_memory = true;
  master::Run run(folder.path() / "test.json", options);
  run.run();
  EXPECT_THAT(run.memory().times_s(), AllOf(Contains(0.3333), Contains(1.7), Contains(4.9)));
}

TEST(StepControl, OthersSeeATickAtTheNextPointOfTheGrid) {
  // The clocks of m (tests/fmus/metronome.cpp) tick at 0.15 s, 0.17 s, 0.45 s and so on. The masses a and b alone would
  // permit longer steps.
  static const test::ChangedFmu held("coupling", R"(canInterpolateInputs="true" maxOutputDerivativeOrder="2")", "");
  TestRun run(
      fmt::format(R"({{"step": 0.01, "stop_time": 1, "step_control": {{"max_step": 0.5, "relative_tolerance": 1}},
      "instances": {{"m": {{"fmu": "{0}"}}, "a": {{"fmu": "{1}"}}, "b": {{"fmu": "{1}"}}}},
      "connections": [{{"from": "a.mass_x", "to": "b.mass_u"}}], "record": ["m.beats", "m.tock_time"]}})",
                  METRONOME_FMU, held.path().string()));
  const auto times = run.to_end().column("time");
  EXPECT_THAT(times, AllOf(Contains(0.15), Contains(0.17), Contains(0.45), Contains(0.47), Contains(0.75)));
  EXPECT_LT(times.size(), 40U);
  const auto beats = run.column("m.beats");
  EXPECT_EQ(beats[static_cast<std::size_t>(std::ranges::find(times, 0.45) - times.begin())], 2);
}

/// Returns a config in which the rest position of a spring jumps from 0.1 m to 0 at 2.345 s. Other instances cannot
/// predict the jump.
std::string jump(const std::string& rollback, double tolerance = 1e-4) {
  static const test::ChangedFmu held("oscillator", R"(canInterpolateInputs="true" maxOutputDerivativeOrder="1")", "");
  return fmt::format(R"({{"step": 0.00001, "stop_time": 4,
      "step_control": {{"max_step": 0.2, "relative_tolerance": {2}, "rollback": "{1}"}}, "instances": {{
        "a": {{"fmu": "{0}", "parameters": {{"stiffness": 0}}}},
        "b": {{"fmu": "{0}", "parameters": {{"stiffness": 100, "grip": 50, "damping": 1, "rest": 0.1, "x": 0.1, "y": 0.1,
                                            "rest_until": 2.345}}}}}},
      "connections": [{{"from": "a.velocity", "to": "b.other_velocity"}},
                      {{"from": "b.pull", "to": "a.force"}}],
      "record": {{"variables": ["*.x"], "step": true}}}})",
                     held.path().string(), rollback, tolerance);
}

TEST(StepControl, LimitsTheStepOverAJumpWithRollback) {
  TestRun never(jump("never"));
  TestRun required(jump("required"));
  const auto& without = *never.to_end().simulation().step_statistics();
  const auto& with = *required.to_end().simulation().step_statistics();
  EXPECT_GT(without.above, 0);
  EXPECT_GT(without.largest_error, 10);
  EXPECT_EQ(with.above, 0);
  EXPECT_LE(with.largest_error, 1);
  EXPECT_GT(with.rejected, 0);
  const auto steps = required.column("step");
  EXPECT_NEAR(*std::ranges::max_element(steps), 0.2, 1e-12) << "before the jump, all is at rest";
}

TEST(StepControl, ARejectedStepLeavesNoTrace) {
  // Runs again with the accepted steps only: the scenario has an entry at the end of each of them. The results must
  // have the same bits.
  TestRun repeated(jump("required"));
  const auto times = repeated.to_end().column("time");
  ASSERT_GT(repeated.simulation().step_statistics()->rejected, 0);
  std::string scenario;
  for (const auto time : times) {
    if (time > 0)
      scenario += fmt::format(R"({}{{"variable": "a.other_velocity", "set": 0, "from": {}}})",
                              scenario.empty() ? "" : ", ", time);
  }
  auto config = jump("never");
  const std::string start = R"("max_step": 0.2,)";
  config.replace(config.find(start), start.size(), R"("max_step": 0.2, "initial_step": 0.2,)");
  config.insert(1, fmt::format(R"("scenario": [{}], )", scenario));
  TestRun straight(config);
  EXPECT_EQ(straight.to_end().column("time"), times);
  EXPECT_EQ(straight.csv(), repeated.csv());
}

TEST(StepControl, TheBitsDoNotDependOnThreadsOrProcesses) {
  for (const char* algorithm : {R"("jacobi")", R"("gauss-seidel")"}) {
    Settings settings{.of_record = R"(, "step": true)", .more = fmt::format(R"("algorithm": {},)", algorithm)};
    TestRun one(masses(settings));
    const auto straight = one.to_end().csv();
    settings.of_a = R"(, "process": "own")";
    TestRun own(masses(settings));
    EXPECT_EQ(own.to_end().csv(), straight);
    settings.more += R"("threads": 2,)";
    settings.of_a = "";
    TestRun threads(masses(settings));
    EXPECT_EQ(threads.to_end().csv(), straight);
  }
}

TEST(StepControl, ARestoredRunTakesTheSameSteps) {
  for (const char* rollback : {"never", "required"}) {
    TestRun run(jump(rollback));
    auto& simulation = run.initialize().simulation();
    while (simulation.time_ns() < 2'300'000'000) simulation.step();
    const auto state = simulation.save_state();
    const auto point = simulation.grid_point();
    const auto remaining = [&] {
      std::vector<std::int64_t> points{simulation.grid_point()};
      while (simulation.step()) points.push_back(simulation.grid_point());
      points.push_back(simulation.step_statistics()->rejected);
      return points;
    };
    const auto straight = remaining();
    simulation.restore_state(state);
    EXPECT_EQ(simulation.grid_point(), point);
    EXPECT_EQ(remaining(), straight);
  }
}

TEST(StepControl, PausesDoNotChangeTheSteps) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  test::write_file(folder.path() / "test.json", masses({}));
  master::Run straight(folder.path() / "test.json");
  straight.run();
  master::Run paused(folder.path() / "test.json");
  for (std::int64_t time_ns = 0; time_ns < 5'000'000'000; time_ns += 33'000'000) paused.run_until(time_ns);
  paused.run();
  EXPECT_EQ(paused.report().steps, straight.report().steps);
  EXPECT_EQ(paused.summary()["step_control"], straight.summary()["step_control"]);
}

TEST(StepControl, ASystemOfModelExchangeTakesItsSteps) {
  TestRun run(fmt::format(R"({{"step": 0.001, "stop_time": 3, "step_control": {{"max_step": 0.2}}, "instances": {{
      "s": {{"fmu": "{}"}}, "a": {{"fmu": "COUPLING"}}}},
    "connections": [{{"from": "a.mass_x", "to": "s.force[1]"}}], "record": ["s.x*"]}})",
                          SPRINGS_FMU));
  run.to_end();
  EXPECT_NEAR(run.column("s.x[1]").back(), std::cos(3), 1e-4);
  EXPECT_LT(run.simulation().steps_done(), 60) << "the mass of a rests, so nothing limits the step";
}

TEST(StepControl, LimitsThatContradictEachOtherAreRefused) {
  EXPECT_THAT(refusal({.control = R"({"max_step": 0.1, "min_step": 0.2})"}),
              AllOf(HasSubstr("/step_control"), HasSubstr("\"min_step\" 0.2 s is longer than \"max_step\" 0.1 s")));
  EXPECT_THAT(refusal({.control = R"({"max_step": 0.1, "initial_step": 0.2})"}),
              HasSubstr("\"initial_step\" 0.2 s is not between"));
  EXPECT_THAT(refusal({.control = R"({"max_step": 0.00015})"}),
              AllOf(HasSubstr("/step_control/max_step"), HasSubstr("not a multiple of the system's step 0.0001 s")));
  EXPECT_THAT(refusal({.control = R"({"max_step": 0.1, "rollback": "requird"})"}), HasSubstr("required"));
  EXPECT_THAT(refusal({.control = R"({"max_step": 0.1, "safety": 1.1})"}), HasSubstr("/step_control/safety"));
}

TEST(StepControl, UnknownNamesOfTolerancesAreRefusedWithTheNearest) {
  EXPECT_THAT(refusal({.control = R"({"max_step": 0.1, "tolerances": {"a.mass_w": false}})"}),
              AllOf(HasSubstr("/step_control/tolerances/a.mass_w"), HasSubstr("a.mass_u")));
  EXPECT_THAT(refusal({.control = R"({"max_step": 0.1, "tolerances": {"a.mass_u": false, "b.mass_u": false}})"}),
              HasSubstr("there is nothing to measure"));
}

TEST(StepControl, AToleranceOfOneInputCountsForItAlone) {
  const auto steps = [](const std::string& tolerances) {
    TestRun run(masses({.control = R"({"max_step": 0.1, "tolerances": )" + tolerances + "}"}));
    return run.to_end().simulation().steps_done();
  };
  const auto both = steps("{}");
  EXPECT_EQ(steps(R"({"a.mass_u": true})"), both);
  EXPECT_GT(steps(R"({"a.mass_u": {"relative": 1e-5}})"), 2 * both);
  EXPECT_LE(steps(R"({"a.mass_u": false})"), both);
}

TEST(StepControl, InstancesThatCannotChangeTheirStepAreNamed) {
  const test::ChangedFmu rigid("oscillator", R"(canHandleVariableCommunicationStepSize="true" )", "");
  const auto config = [&](const std::string& more) {
    return fmt::format(R"({{"step": 0.01, "stop_time": 1, "step_control": {{"max_step": 0.1}}, "instances": {{
        "a": {{"fmu": "{0}"}}, "b": {{"fmu": "{1}" {2}}}}},
      "connections": [{{"from": "b.velocity", "to": "a.other_velocity"}}]}})",
                       OSCILLATOR_FMU, rigid.path().string(), more);
  };
  EXPECT_THAT(test::input_error([&] { TestRun run(config("")); }),
              AllOf(HasSubstr("/step_control: these instances cannot change their communication step"),
                    HasSubstr("'b' (oscillator). Give each a \"step\" that is longer than the system's step 0.01 s"),
                    Not(HasSubstr("'a'"))));
  TestRun run(config(R"(, "step": 0.05)"));
  EXPECT_EQ(run.to_end().column("time").back(), 1);
}

TEST(StepControl, ARollbackThatAnFmuDoesNotOfferIsRefusedOrNoted) {
  const test::ChangedFmu forgetful("oscillator", R"(canGetAndSetFMUstate="true")", "");
  const auto with = [&](const std::string& rollback) {
    return fmt::format(R"({{"step": 0.01, "stop_time": 1, "step_control": {{"max_step": 0.1, "rollback": "{2}"}},
        "instances": {{"a": {{"fmu": "{0}"}}, "b": {{"fmu": "{1}"}}}},
        "connections": [{{"from": "b.velocity", "to": "a.other_velocity"}}]}})",
                       OSCILLATOR_FMU, forgetful.path().string(), rollback);
  };
  EXPECT_THAT(test::input_error([&] { TestRun run(with("required")); }),
              AllOf(HasSubstr("/step_control/rollback"), HasSubstr("'b' (oscillator)"), Not(HasSubstr("'a'"))));
  TestRun run(with("if_possible"));
  EXPECT_THAT(run.system.notices, Contains(HasSubstr("step_control repeats no steps: ")));
  EXPECT_EQ(run.to_end().simulation().step_statistics()->rejected, 0);
}

}  // namespace
}  // namespace mebots::master
