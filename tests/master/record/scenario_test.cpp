// SPDX-License-Identifier: Apache-2.0
#include "record/scenario.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <numeric>

namespace mebots::master {
namespace {

using test::TestRun;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

/// Returns a config in which outputs of a are inputs of b. `scenario` contains the entries of the list "scenario".
std::string system_with(const std::string& scenario, const std::string& more = "") {
  return R"({"step": 0.1, "stop_time": 1, "instances": {
      "a": {"fmu": "PROBE", "parameters": {"real_in": 2, "integer_in": 4}}, "b": {"fmu": "PROBE")" +
         more + R"(}},
    "connections": [{"from": "a.real_out", "to": "b.real_in"}, {"from": "a.integer_out", "to": "b.integer_in"},
                    {"from": "a.boolean_out", "to": "b.boolean_in"}, {"from": "a.string_out", "to": "b.string_in"}],
    "scenario": [)" +
         scenario + R"(],
    "record": ["a.real_in", "a.real_out", "a.last_end", "a.steps", "a.integer_out", "a.boolean_out", "a.string_out",
               "b.real_in", "b.integer_in"]})";
}

std::vector<double> column(const std::string& scenario, const std::string& name) {
  TestRun run(system_with(scenario));
  run.to_end();
  return run.column(name);
}

TEST(Scenario, AnOutputIsSetBetweenTwoTimesAsAllOthersSeeIt) {
  TestRun run(system_with(R"({"variable": "a.real_out", "set": 7, "from": 0.3, "until": 0.6})"));
  run.to_end();
  EXPECT_THAT(run.column("a.real_out"), ElementsAre(2, 2, 2, 7, 7, 7, 2, 2, 2, 2, 2));
  // The value is set at the start of the step. Its effect is visible at the next point.
  EXPECT_THAT(run.column("b.real_in"), ElementsAre(2, 2, 2, 2, 7, 7, 7, 2, 2, 2, 2));
}

TEST(Scenario, AnInputIsOverriddenForItsFmuOnly) {
  TestRun run(system_with(R"({"variable": "b.real_in", "offset": 0.5, "from": 0.3, "until": 0.5})"));
  run.to_end();
  EXPECT_THAT(run.column("a.real_out"), testing::Each(2));
  EXPECT_THAT(run.column("b.real_in"), ElementsAre(2, 2, 2, 2, 2.5, 2.5, 2, 2, 2, 2, 2));
}

TEST(Scenario, AnInputWithoutASourceGoesBackToItsStartValue) {
  EXPECT_THAT(column(R"({"variable": "a.real_in", "set": 5, "from": 0.2, "until": 0.4})", "a.real_out"),
              ElementsAre(2, 2, 2, 5, 5, 2, 2, 2, 2, 2, 2));
}

TEST(Scenario, OverridesOfOneVariableActInTheirOrder) {
  EXPECT_THAT(column(R"({"variable": "a.real_out", "scale": 3, "from": 0.2, "until": 0.8},
                        {"variable": "a.real_out", "offset": 1, "from": 0.4, "until": 0.6})",
                     "a.real_out"),
              ElementsAre(2, 2, 6, 6, 7, 7, 6, 6, 2, 2, 2));
  EXPECT_THAT(column(R"({"variable": "a.real_out", "offset": 1, "from": 0.4, "until": 0.6},
                        {"variable": "a.real_out", "scale": 3, "from": 0.2, "until": 0.8})",
                     "a.real_out"),
              ElementsAre(2, 2, 6, 6, 9, 9, 6, 6, 2, 2, 2));
}

TEST(Scenario, AFrozenVariableKeepsTheValueOfTheFirstMoment) {
  EXPECT_THAT(column(R"({"variable": "a.steps", "freeze": true, "from": 0.3, "until": 0.7})", "a.steps"),
              ElementsAre(0, 1, 2, 3, 3, 3, 3, 7, 8, 9, 10));
}

TEST(Scenario, ARampGoesFromTheValueFoundToItsGoalAndStaysThere) {
  const auto values =
      column(R"({"variable": "a.real_out", "ramp": 4, "over": 0.4, "from": 0.2, "until": 0.9})", "a.real_out");
  const std::vector<double> expected = {2, 2, 2, 2.5, 3, 3.5, 4, 4, 4, 2, 2};
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(values[i], expected[i], 1e-15) << i;  // rounding
}

TEST(Scenario, AConditionStartsItOnceForItsDuration) {
  // The condition is true from 0.3 s, and for 0.1 s at 0.4 s. Outputs show the override at the next point.
  TestRun run(system_with(R"({"variable": "a.real_out", "set": 7,
      "when": {"variable": "a.steps", "above": 2, "for": 0.1}, "duration": 0.3})"));
  run.to_end();
  EXPECT_THAT(run.column("a.real_out"), ElementsAre(2, 2, 2, 2, 2, 7, 7, 2, 2, 2, 2));
  EXPECT_THAT(column(R"({"variable": "a.real_in", "set": 7, "when": {"variable": "a.steps", "equals": 4},
                         "until": 0.7})",
                     "a.real_out"),
              ElementsAre(2, 2, 2, 2, 2, 7, 7, 7, 2, 2, 2));
}

TEST(Scenario, IntegersBooleansAndTextsCanBeSetAndFrozen) {
  TestRun run(system_with(R"({"variable": "a.integer_out", "set": -3, "from": 0.5},
      {"variable": "a.boolean_out", "set": false, "from": 0.5}, {"variable": "a.string_out", "set": "x", "from": 0.9})"));
  run.to_end();
  EXPECT_THAT(run.column("a.integer_out"), ElementsAre(5, 5, 5, 5, 5, -3, -3, -3, -3, -3, -3));
  EXPECT_THAT(run.column("a.boolean_out"), ElementsAre(1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0));
  EXPECT_THAT(run.csv(), AllOf(HasSubstr(",!,"), HasSubstr(",x,")));
}

TEST(Scenario, NoiseIsNormalAndTheSameEveryTime) {
  const auto noisy = [](const std::string& scenario) {
    auto text = system_with(scenario);
    text.replace(text.find(R"("stop_time": 1)"), 14, R"("stop_time": 2000)");
    TestRun run(text);
    run.to_end();
    return run.column("a.real_out");
  };
  const auto values = noisy(R"({"variable": "a.real_out", "noise": 0.5, "seed": 3})");
  EXPECT_EQ(values, noisy(R"({"variable": "a.real_out", "noise": 0.5, "seed": 3})"));
  EXPECT_NE(values, noisy(R"({"variable": "a.real_out", "noise": 0.5, "seed": 4})"));
  const auto count = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  double square = 0;
  double neighbours = 0;
  double beyond_two = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double off = values[i] - 2;
    square += off * off;
    if (i > 0) neighbours += off * (values[i - 1] - 2);
    beyond_two += std::abs(off) > 1 ? 1 : 0;
  }
  // There are 20001 values. The tolerances are four standard errors.
  EXPECT_NEAR(mean, 2, 4 * 0.5 / std::sqrt(count));
  EXPECT_NEAR(square / count, 0.25, 4 * 0.25 * std::sqrt(2 / count));
  EXPECT_NEAR(neighbours / square, 0, 4 / std::sqrt(count));
  EXPECT_NEAR(beyond_two / count, 0.0455, 4 * std::sqrt(0.0455 / count));
}

TEST(Scenario, RefusesInvalidEntriesBeforeTheFirstStep) {
  const auto refused = [](const std::string& scenario) {
    return test::input_error([&] {
      TestRun run(system_with(scenario));
      const OverrideSchedule checked(run.system);
    });
  };
  EXPECT_THAT(refused(R"({"variable": "a.real_uot", "set": 1})"),
              AllOf(HasSubstr("/scenario/0"), HasSubstr("real_out")));
  EXPECT_THAT(refused(R"({"variable": "a.gain", "set": 1})"), HasSubstr("parameter of variability fixed"));
  EXPECT_THAT(refused(R"({"variable": "a.real_out", "set": "high"})"), HasSubstr("takes a finite number"));
  EXPECT_THAT(refused(R"({"variable": "a.steps", "offset": 1})"), HasSubstr("works on Real variables"));
  EXPECT_THAT(refused(R"({"variable": "a.real_out", "set": 1, "unit": "km"})"), HasSubstr("is in [metre]"));
  EXPECT_THAT(refused(R"({"variable": "a.buffer.size", "set": 1})"), HasSubstr("binary variable"));
  EXPECT_THAT(refused(R"({"variable": "a.real_out", "noise": 1})"), HasSubstr("'seed' is missing"));
  EXPECT_THAT(refused(R"({"variable": "a.real_out", "set": 1, "freeze": true})"), HasSubstr("exactly one of"));
  EXPECT_THAT(refused(R"({"variable": "a.real_out", "set": 1, "over": 1})"),
              HasSubstr("allowed only together with 'ramp'"));
  EXPECT_THAT(refused(R"({"variable": "a.real_out", "set": 1, "from": 2, "until": 1})"),
              HasSubstr("must be after 'from'"));
}

TEST(Scenario, ReportSaysWhatActedWhen) {
  TestRun run(system_with(R"({"text": "a push", "variable": "a.real_in", "set": 7,
                              "when": {"variable": "a.steps", "equals": 4}, "duration": 0.2},
                             {"variable": "a.real_out", "scale": 2, "from": 3}, {"variable": "a.real_out", "scale": 2})"));
  run.to_end();
  const auto report = run.scenario->report(run.system, run.simulation().time_ns());
  ASSERT_EQ(report.size(), 3u);
  EXPECT_EQ(report[0], nlohmann::ordered_json::parse(R"({"variable": "a.real_in", "action": "set 7", "text": "a push",
                                                         "applied": true, "from": 0.4, "until": 0.6})"));
  EXPECT_EQ(report[1]["applied"], false);
  EXPECT_EQ(report[2]["until"], 1.0);
}

TEST(Scenario, ItsStateIsSavedWithTheRun) {
  const auto text = system_with(R"({"variable": "a.steps", "freeze": true, "from": 0.3, "until": 0.8},
      {"variable": "a.real_in", "ramp": 9, "over": 0.4, "when": {"variable": "a.steps", "above": 1, "for": 0.1}},
      {"variable": "b.real_in", "noise": 1, "seed": 1})",
                                R"(, "process": "own")");
  TestRun straight(text);
  straight.to_end();
  std::vector<std::byte> bytes;
  {
    TestRun first(text);
    first.initialize();
    for (int i = 0; i < 5; ++i) first.simulation().step();
    bytes = first.simulation().serialize(first.simulation().save_state());
  }
  TestRun second(text);
  second.initialize();
  const auto kept = second.simulation().save_state();  // the FMUs must then keep data to return to this state
  for (int i = 0; i < 9; ++i) second.simulation().step();
  second.simulation().restore_state(second.simulation().deserialize(bytes));
  while (second.simulation().step()) {
  }
  EXPECT_EQ(second.csv(), straight.csv());
}

}  // namespace
}  // namespace mebots::master
