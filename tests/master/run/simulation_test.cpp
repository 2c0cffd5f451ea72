// SPDX-License-Identifier: Apache-2.0
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/lsan_interface.h>
#endif

namespace mebots::master {
namespace {

using test::TestRun;
using testing::AllOf;
using testing::HasSubstr;

std::string one_probe(const std::string& parameters, const std::string& more = "",
                      const std::string& times = R"("step": 0.1, "stop_time": 1)") {
  return fmt::format(R"({{{}, "instances": {{"a": {{"fmu": "PROBE", "parameters": {{{}}}}}}}, "connections": []{}}})",
                     times, parameters, more);
}

TEST(Simulation, TimesAreCountedSoThatALongRunEndsExactly) {
  TestRun run(one_probe("", R"(, "record": {"variables": ["a.steps", "a.last_end"], "interval": 1000})",
                        R"("step": 0.1, "stop_time": 100000)"));
  run.to_end();
  EXPECT_EQ(run.simulation().time_ns(), 100'000'000'000'000);
  EXPECT_EQ(run.column("a.steps").back(), 1'000'000);
  EXPECT_EQ(run.column("time").back(), 100000.0);
  // The FMU adds t and h. The result has one rounding of a number near 1e5.
  EXPECT_NEAR(run.column("a.last_end").back(), 100000.0, 2e-11);
}

TEST(Simulation, RowsStandAtTheStartAndAtEveryCommunicationPoint) {
  TestRun run(one_probe("", "", R"("step": 0.002, "stop_time": 0.01)"));
  EXPECT_THAT(run.to_end().column("time"), testing::ElementsAre(0, 0.002, 0.004, 0.006, 0.008, 0.01));
}

TEST(Simulation, OutputsTravelInOneStepAsJacobiSays) {
  // a counts its steps. b adds the count of a at t_k to a sum.
  TestRun run(R"({"step": 0.5, "stop_time": 2, "instances": {
      "a": {"fmu": "PROBE", "parameters": {"real_in": 1}},
      "b": {"fmu": "PROBE"}, "c": {"fmu": "PROBE"}},
    "connections": [{"from": "a.steps", "to": "b.integer_in"}, {"from": "b.integer_out", "to": "c.integer_in"}]})");
  run.to_end();
  EXPECT_THAT(run.column("a.steps"), testing::ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(run.column("b.integer_out"), testing::ElementsAre(1, 1, 2, 3, 4));  // steps of a at t_k-1, plus one
  EXPECT_THAT(run.column("c.integer_out"), testing::ElementsAre(2, 2, 2, 3, 4));
}

TEST(Simulation, ADirectChainHasItsInitialValuesAtTheStart) {
  TestRun run(R"({"step": 0.1, "stop_time": 0.1, "instances": {
      "d": {"fmu": "PROBE", "parameters": {"gain": 2}}, "c": {"fmu": "PROBE", "parameters": {"gain": 2}},
      "b": {"fmu": "PROBE", "parameters": {"gain": 2}}, "a": {"fmu": "PROBE", "parameters": {"offset": 1}}},
    "connections": [{"from": "c.real_out", "to": "d.real_in"}, {"from": "b.real_out", "to": "c.real_in"}, {"from": "a.real_out", "to": "b.real_in"},
                    {"from": "a.string_out", "to": "b.string_in"}, {"from": "b.boolean_out", "to": "a.boolean_in"}]})");
  run.initialize();
  EXPECT_EQ(run.column("d.real_out").front(), 8);
  EXPECT_EQ(run.column("a.boolean_out").front(), 0);
}

TEST(Simulation, AnInitialLoopThatConvergesIsSolved) {
  // x = 0.5 y + 1 and y = 0.5 x have the solution x = 4/3 and y = 2/3.
  TestRun run(R"({"step": 0.1, "stop_time": 0.1, "instances": {
      "a": {"fmu": "PROBE", "parameters": {"gain": 0.5, "offset": 1}}, "b": {"fmu": "PROBE", "parameters": {"gain": 0.5}}},
    "connections": [{"from": "a.real_out", "to": "b.real_in"}, {"from": "b.real_out", "to": "a.real_in"}]})");
  run.initialize();
  EXPECT_NEAR(run.column("a.real_out").front(), 4.0 / 3,
              4e-12);  // relative convergence of 1e-12 per sweep; the gain of a round is 0.25
  EXPECT_NEAR(run.column("b.real_out").front(), 2.0 / 3, 4e-12);
}

TEST(Simulation, AnInitialLoopThatDivergesIsReportedWithItsPath) {
  TestRun run(R"({"step": 0.1, "stop_time": 0.1, "instances": {
      "a": {"fmu": "PROBE", "parameters": {"gain": 1, "offset": 1}}, "b": {"fmu": "PROBE"}},
    "connections": [{"from": "a.real_out", "to": "b.real_in"}, {"from": "b.real_out", "to": "a.real_in"}]})");
  try {
    run.initialize();
    FAIL() << "the loop x = 1 + x has no solution";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("do not converge"),
                                    HasSubstr("a.real_in -> a.real_out -> b.real_in -> b.real_out -> a.real_in")));
  }
}

/// Returns a config of three instances in a ring, in the order of `names`, with different parameters.
std::string ring(const std::vector<std::string>& names) {
  const auto instance = [](const std::string& name) {
    const int number = name[0] - 'a' + 1;
    return fmt::format(R"("{}": {{"fmu": "PROBE", "parameters": {{"gain": {}, "offset": {}}}, "step": {}}})", name,
                       -0.3 * number, 0.7 * number, number == 3 ? 0.02 : 0.01);
  };
  std::vector<std::string> instances;
  for (const auto& name : names) instances.push_back(instance(name));
  return fmt::format(R"({{"step": 0.01, "stop_time": 5, "instances": {{{}, {}, {}}},
    "connections": [{{"from": "a.real_out", "to": "b.real_in"}}, {{"from": "b.real_out", "to": "c.real_in"}}, {{"from": "c.real_out", "to": "a.real_in"}}]}})",
                     instances[0], instances[1], instances[2]);
}

TEST(Simulation, DoesNotDependOnTheOrderOfInstances) {
  TestRun first(ring({"a", "b", "c"}));
  first.to_end();
  for (const auto& order : {std::vector<std::string>{"c", "b", "a"}, {"b", "c", "a"}, {"c", "a", "b"}}) {
    TestRun other(ring(order));
    other.to_end();
    for (const char* name : {"a.real_out", "b.integral", "c.real_out", "c.integral"}) {
      EXPECT_EQ(first.column(name), other.column(name)) << name;
    }
  }
}

TEST(Simulation, TwoRunsGiveTheSameBytes) {
  EXPECT_EQ(TestRun(ring({"a", "b", "c"})).to_end().csv(), TestRun(ring({"a", "b", "c"})).to_end().csv());
}

TEST(Simulation, AnInstanceWithALongerStepShowsItsOutputsWhenTheOthersArrive) {
  TestRun run(R"({"step": 0.1, "stop_time": 0.6, "instances": {
      "fast": {"fmu": "PROBE"}, "slow": {"fmu": "PROBE", "step": 0.3}},
    "connections": [{"from": "fast.steps", "to": "slow.integer_in"}, {"from": "slow.steps", "to": "fast.integer_in"}],
    "record": ["fast.steps", "slow.steps", "fast.integer_out", "slow.integer_out", "slow.last_end", "slow.last_step"]})");
  run.to_end();
  EXPECT_THAT(run.column("slow.steps"), testing::ElementsAre(0, 0, 0, 1, 1, 1, 2));
  EXPECT_THAT(run.column("slow.last_end"), testing::ElementsAre(0, 0, 0, 0.3, 0.3, 0.3, 0.6));
  EXPECT_EQ(run.column("slow.last_step").back(), 0.3);
  EXPECT_THAT(run.column("fast.integer_out"), testing::ElementsAre(1, 1, 1, 1, 2, 2, 2));
  EXPECT_THAT(run.column("slow.integer_out"), testing::ElementsAre(1, 1, 1, 1, 1, 1, 4));
}

TEST(Simulation, ABufferIsReadBeforeItsOwnerStepsOn) {
  // At t_k, the buffer of a contains 16 times the number of its steps. b adds it in the next step.
  for (const char* instances :
       {R"("a": {"fmu": "PROBE"}, "b": {"fmu": "PROBE"})", R"("b": {"fmu": "PROBE"}, "a": {"fmu": "PROBE"})"}) {
    TestRun run(fmt::format(
        R"({{"step": 0.1, "stop_time": 0.5, "instances": {{{}}}, "connections": [{{"from": "a.buffer", "to": "b.taken"}}]}})",
        instances));
    run.to_end();
    EXPECT_THAT(run.column("b.taken_sum"), testing::ElementsAre(0, 0, 16, 32, 48, 64));
  }
}

TEST(Simulation, MessagesOfWantedCategoriesArrive) {
  TestRun run(one_probe(""));
  run.to_end();
  EXPECT_THAT(run.messages.lines, testing::ElementsAre("a/console: hello from the first step (0.1)"));
  TestRun chatty(one_probe("", R"(, "log": {"a": ["*"]})"));
  chatty.to_end();
  EXPECT_THAT(chatty.messages.lines, testing::Contains("a/chatter: nobody asked for this (0.1)"));
  TestRun silent(one_probe("", R"(, "log": {"a": []})"));
  silent.to_end();
  EXPECT_TRUE(silent.messages.lines.empty());
}

std::string failure(TestRun& run) {
  try {
    run.to_end();
  } catch (const SlaveError& error) {
    return error.what();
  }
  return "nothing went wrong";
}

std::string with_fault(const std::string& fault) {
  return one_probe(fmt::format(R"("fault": "{}", "fault_time": 0.5)", fault));
}

std::string failure(const std::string& fault) {
  TestRun run(with_fault(fault));
  return failure(run);
}

TEST(Faults, AnErrorNamesInstanceTimeFunctionAndTheFmusWords) {
  TestRun run(with_fault("error"));
  EXPECT_THAT(failure(run), AllOf(HasSubstr("instance 'a' at 0.4 s"), HasSubstr("fmi2DoStep returned fmi2Error"),
                                  HasSubstr("real_in made it fail (0)")));       // the FMU's text contained #r0#
  EXPECT_THAT(run.column("time"), testing::ElementsAre(0, 0.1, 0.2, 0.3, 0.4));  // earlier rows remain
}

TEST(Faults, AFatalErrorIsNotFollowedByAnotherCall) {
#ifdef __SANITIZE_ADDRESS__
  const __lsan::ScopedDisabler unfreed;  // memory stays allocated, because fmi2FreeInstance must not be called
#endif
  EXPECT_THAT(failure("fatal"), HasSubstr("fmi2Fatal"));
}

TEST(Faults, ADiscardedStepEndsTheRun) {
  EXPECT_THAT(failure("discard"), AllOf(HasSubstr("instance 'a' at 0.4 s"),
                                        HasSubstr("fmi2DoStep discarded a step of 0.1 s"), HasSubstr("reaching 0.42")));
}

TEST(Faults, NotANumberIsCaughtInTheStepWhereItAppears) {
  EXPECT_THAT(failure("nan"), AllOf(HasSubstr("instance 'a' at 0.5 s"), HasSubstr("'real_out' is nan")));
  EXPECT_THAT(failure("infinity"), AllOf(HasSubstr("instance 'a' at 0.5 s"), HasSubstr("'integral' is -inf")));
}

TEST(Faults, AWarningIsShownAndTheRunContinues) {
  TestRun run(one_probe(R"("fault": "warning", "fault_time": 0.5)"));
  run.to_end();
  EXPECT_EQ(run.simulation().end().reason, EndReason::stop_time);
  EXPECT_THAT(run.messages.lines, testing::Contains(HasSubstr("something is odd")).Times(6));
}

TEST(Faults, AnFmuMayEndTheSimulation) {
  TestRun run(one_probe(R"("fault": "terminate", "fault_time": 0.5)"));
  run.to_end();
  EXPECT_EQ(run.simulation().end().reason, EndReason::terminated);
  EXPECT_THAT(run.simulation().end().text, AllOf(HasSubstr("'a' ended the simulation"), HasSubstr("0.42")));
  EXPECT_EQ(run.column("time").back(), 0.4);
  EXPECT_NO_THROW(run.simulation().terminate());
}

TEST(Faults, AnInstanceThatRefusesItsParametersIsBadInput) {
  EXPECT_THAT(test::input_error([] { TestRun(one_probe(R"("fault": "initialisation")")).initialize(); }),
              AllOf(HasSubstr("fmi2EnterInitializationMode"), HasSubstr("does not like its parameters")));
}

TEST(StopWhen, TheRunEndsAtTheFirstPointWhereAConditionHolds) {
  TestRun run(
      one_probe(R"("real_in": 1)",
                R"(, "stop_when": [{"variable": "a.steps", "above": 90}, {"variable": "a.steps", "equals": 4}])"));
  run.to_end();
  EXPECT_EQ(run.simulation().end().reason, EndReason::stop_condition);
  EXPECT_EQ(run.simulation().end().text, "a.steps = 4 at 0.4 s");
  EXPECT_EQ(run.column("time").back(), 0.4);
}

class PointsOfRun final : public Observer {
 public:
  std::optional<std::string> reached(const Point& point) override {
    reached_points.push_back(point.step);
    return std::nullopt;
  }
  void continues(const Point& point) override { continued_points.push_back(point.step); }

  std::vector<std::int64_t> reached_points;
  std::vector<std::int64_t> continued_points;
};

TEST(Simulation, ARunDoesNotContinueAtItsEnd) {
  PointsOfRun points;
  TestRun run(R"({"step": 0.5, "stop_time": 1, "instances": {"a": {"fmu": "PROBE"}}, "connections": []})");
  run.simulation().add(points);
  run.to_end();
  EXPECT_THAT(points.reached_points, testing::ElementsAre(0, 1, 2));
  EXPECT_THAT(points.continued_points, testing::ElementsAre(0, 1))
      << "a checkpoint at 2 would be resumed beyond the end";
}

TEST(StopWhen, AConditionMayHaveToHoldForATime) {
  TestRun run(one_probe("", R"(, "stop_when": [{"variable": "a.steps", "above": 3, "for": 0.3}])"));
  run.to_end();
  EXPECT_EQ(run.column("time").back(), 0.7);  // the value is above 3 from 0.4 s
}

TEST(StopWhen, ABreakStartsTheTimeAnew) {
  // The sum over the buffer rises to 16 * 255 and falls to 0 every 256 steps. It is above 4000 for 0.4 s each time.
  const auto stopping = [](const std::string& duration) {
    TestRun run(R"({"step": 0.1, "stop_time": 60, "instances": {"a": {"fmu": "PROBE"}, "b": {"fmu": "PROBE"}},
      "connections": [{"from": "a.buffer", "to": "b.taken"}], "record": ["b.taken_sum"],
      "stop_when": [{"variable": "b.taken_sum", "above": 4000, "for": )" +
                duration + "}]}");
    run.to_end();
    return run.simulation().end().reason;
  };
  EXPECT_EQ(stopping("0.4"), EndReason::stop_condition);
  EXPECT_EQ(stopping("0.5"), EndReason::stop_time);
}

TEST(StopWhen, TheStartCountsToo) {
  TestRun run(one_probe("", R"(, "stop_when": [{"variable": "a.steps", "below": 1}])"));
  run.to_end();
  EXPECT_THAT(run.column("time"), testing::ElementsAre(0));
}

TEST(Outcomes, TheFirstThatHoldsCounts) {
  const std::string rules = R"(, "outcomes": [
    {"outcome": "never", "when": [{"variable": "a.steps", "above": 1000, "ever": true}]},
    {"outcome": "was at three", "when": [{"variable": "a.steps", "equals": 3, "ever": true}, {"variable": "a.real_out", "above": 4.5}]},
    {"outcome": "is at ten", "when": [{"variable": "a.steps", "equals": 10}]},
    {"outcome": "else"}])";
  EXPECT_EQ(TestRun(one_probe(R"("real_in": 5)", rules)).to_end().outcomes->outcome(), "was at three");
  EXPECT_EQ(TestRun(one_probe(R"("real_in": 4)", rules)).to_end().outcomes->outcome(), "is at ten");
  EXPECT_EQ(TestRun(one_probe(R"("real_in": 4)", rules, R"("step": 0.1, "stop_time": 2)")).to_end().outcomes->outcome(),
            "else");
}

TEST(Outcomes, AreCompletedWithoutRules) {
  EXPECT_EQ(TestRun(one_probe("")).to_end().outcomes->outcome(), "completed");
}

TEST(StartTime, TheAxisOfTheResultsBeginsThere) {
  test::TestRun run(R"({"step": 0.1, "start_time": 2.05, "stop_time": 2.45, "instances": {"a": {"fmu": "PROBE"},
    "slow": {"fmu": "PROBE", "step": 0.2}}, "connections": [], "record": ["a.last_end", "slow.last_end"]})");
  run.to_end();
  EXPECT_THAT(run.column("time"), testing::ElementsAre(2.05, 2.15, 2.25, 2.35, 2.45));
  EXPECT_DOUBLE_EQ(run.column("a.last_end").back(), 2.45);
  EXPECT_DOUBLE_EQ(run.column("slow.last_end").at(2), 2.25);
}

TEST(StartTime, StepsMustFitBetweenItAndTheStopTime) {
  const auto error = [](const char* times) {
    return test::input_error([&] {
      test::TestRun(std::string("{\"step\": 0.1, ") + times +
                    R"(, "instances": {"a": {"fmu": "PROBE"}}, "connections": []})");
    });
  };
  EXPECT_THAT(error(R"("start_time": 0.05, "stop_time": 1)"), testing::HasSubstr("the nearest are 0.95 s and 1.05 s"));
  EXPECT_THAT(error(R"("start_time": 1, "stop_time": 1)"), testing::HasSubstr("greater than the start time 1 s"));
  EXPECT_THAT(error(R"("start_time": -1, "stop_time": -1)"), testing::HasSubstr("greater than the start time -1 s"));
  EXPECT_THAT(error(R"("start_time": -9.2e9, "stop_time": 9.2e9)"), testing::HasSubstr("would last longer"));
}

}  // namespace
}  // namespace mebots::master
