// SPDX-License-Identifier: Apache-2.0
// Tests co-simulation FMUs of FMI 1.0 with tests/fmus/tank1.c.
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <string>

namespace mebots::master {
namespace {

using test::TestRun;
using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;

std::string tank(const std::string& name, const std::string& parameters = "", const std::string& more = "") {
  return fmt::format(R"("{}": {{"fmu": "{}", "parameters": {{{}}}{}}})", name, TANK1_FMU, parameters, more);
}

std::string tanks(const std::string& instances, const std::string& connections = "") {
  return fmt::format(R"({{"step": 0.125, "stop_time": 1, "instances": {{{}}}, "connections": [{}]}})", instances,
                     connections);
}

TEST(Fmi1, StepsAndReadsValuesOfAllTypes) {
  TestRun run(tanks(tank("a", R"("area": 0.5)")));
  run.to_end();
  const auto level = run.column("a.level");
  ASSERT_EQ(level.size(), 9U);
  for (std::size_t k = 0; k < level.size(); ++k) EXPECT_EQ(level[k], 0.25 + 0.25 * static_cast<double>(k)) << k;
  EXPECT_EQ(run.column("a.steps").back(), 8);
  EXPECT_EQ(run.column("a.full").front(), 0);
  EXPECT_EQ(run.column("a.full").back(), 1);
}

TEST(Fmi1, NegatesTheValuesOfNegatedAliases) {
  TestRun run(tanks(tank("a", R"("outflow": 3, "minus_offset": 7)")));
  run.to_end();
  EXPECT_THAT(run.column("a.rate"), Each(-1.5)) << "an input of 3 is an inflow of -3";
  EXPECT_THAT(run.column("a.drain"), Each(1.5));
  EXPECT_THAT(run.column("a.offset_seen"), Each(-7));
  EXPECT_EQ(run.column("a.unsteps").back(), -8);
  EXPECT_THAT(run.column("a.not_full"), Each(1));
}

TEST(Fmi1, RefusesAnIntegerWhoseNegativeDoesNotFit) {
  EXPECT_THAT([] { TestRun(tanks(tank("a", R"("minus_offset": -2147483648)"))).to_end(); },
              testing::ThrowsMessage<Error>(HasSubstr("its negative needs more than 32 bits")));
}

TEST(Fmi1, InitialisesWithInputsFromConnections) {
  constexpr const char* kLink = R"({"from": "a.level", "to": "b.initial_level", "convert_units": false},
                                   {"from": "b.level", "to": "c.initial_level", "convert_units": false})";
  constexpr const char* kArea = R"("area": 0.5)";
  TestRun run(tanks(tank("c", kArea) + ", " + tank("b", kArea) + ", " + tank("a", R"("initial_level": 0.75)"), kLink));
  run.to_end();
  EXPECT_EQ(run.column("c.level").front(), 0.75);
  EXPECT_EQ(run.column("c.level").back(), 2.75) << "c keeps its area";
}

TEST(Fmi1, PassesTheStopTimeOnlyIfRequested) {
  TestRun run(tanks(tank("a")));
  run.to_end();
  EXPECT_EQ(run.column("a.has_stop").back(), 0);
  TestRun asked(tanks(tank("a", "", R"(, "pass_stop_time": true)")));
  asked.to_end();
  EXPECT_EQ(asked.column("a.has_stop").back(), 1);
  EXPECT_EQ(asked.column("a.stop").back(), 1);
}

TEST(Fmi1, WaitsForPendingSteps) {
  TestRun run(tanks(tank("a", R"("behaviour": "pending")")));
  run.to_end();
  EXPECT_EQ(run.column("a.level").back(), 0.75);
}

TEST(Fmi1, AMessageAboutAProcessNamesTheCallOfThisVersion) {
  TestRun run(tanks(tank("a", R"("behaviour": "hang")", R"(, "process": "own", "deadline": 0.2)")));
  EXPECT_THAT([&] { run.to_end(); }, testing::ThrowsMessage<Error>(HasSubstr("'a' at 0 s: fmiDoStep did not return")));
}

std::string without_status(const std::string& name, const std::string& behaviour) {
  return fmt::format(R"("{}": {{"fmu": "{}", "parameters": {{"behaviour": "{}"}}}})", name, TANK1_WITHOUT_STATUS_FMU,
                     behaviour);
}

TEST(Fmi1, WaitsForTheCallbackOfEachInstance) {
  TestRun run(tanks(without_status("a", "callback") + ", " + without_status("b", "callback")));
  run.to_end();
  EXPECT_EQ(run.column("a.steps").back(), 8);
  EXPECT_EQ(run.column("b.steps").back(), 8);
}

TEST(Fmi1, TakesACallbackWithAnUnknownComponentIfThereIsOneInstance) {
  TestRun run(tanks(without_status("a", "unknown_callback")));
  run.to_end();
  EXPECT_EQ(run.column("a.steps").back(), 8);
}

TEST(Fmi1, RefusesACallbackWithAnUnknownComponentIfThereAreSeveralInstances) {
  EXPECT_THAT([] { TestRun(tanks(without_status("a", "unknown_callback") + ", " + tank("b"))).to_end(); },
              testing::ThrowsMessage<Error>(
                  AllOf(HasSubstr("'a'"), HasSubstr("unknown instance"), HasSubstr("\"process\": \"own\""))));
}

TEST(Fmi1, ReportsHowFarADiscardedStepCame) {
  EXPECT_THAT(
      [] { TestRun(tanks(tank("a", R"("behaviour": "discard")"))).to_end(); },
      testing::ThrowsMessage<Error>(
          AllOf(HasSubstr("'a'"), HasSubstr("fmiDoStep discarded a step of 0.125 s (fmiDiscard) after reaching 0.5 s"),
                testing::Not(HasSubstr("on_discard")))));
}

TEST(Fmi1, NamesAFatalStatus) {
  EXPECT_THAT([] { TestRun(tanks(tank("a", R"("behaviour": "fatal")"))).to_end(); },
              testing::ThrowsMessage<Error>(AllOf(HasSubstr("'a'"), HasSubstr("fmiDoStep returned fmiFatal"))));
}

TEST(Fmi1, PassesMessagesOn) {
  TestRun run(tanks(tank("a", R"("behaviour": "wordy")")));
  run.to_end();
  EXPECT_THAT(run.messages.lines, Contains(HasSubstr("a/tank: variable level starts at 0.25")));
}

TEST(Fmi1, RunsInAProcessOfItsOwnWithTheSameBits) {
  const auto config = [](const std::string& process) {
    return tanks(tank("a", "", process) + ", " + tank("b", "", process),
                 R"({"from": "a.drain", "to": "b.outflow"}, {"from": "b.unsteps", "to": "a.minus_offset"})");
  };
  TestRun shared(config(""));
  TestRun own(config(R"(, "process": "own")"));
  EXPECT_EQ(shared.to_end().csv(), own.to_end().csv());
}

TEST(Fmi1, SaysThatItHasNoStates) {
  TestRun run(tanks(tank("a")));
  run.initialize();
  EXPECT_THAT([&] { run.simulation().save_state(); },
              testing::ThrowsMessage<Error>(HasSubstr("FMI 1.0 has no states")));
}

TEST(Fmi1, RefusesModelExchangeByName) {
  const test::ChangedFmu fmu("tank1", R"(<Implementation>
    <CoSimulation_StandAlone>
      <Capabilities canHandleVariableCommunicationStepSize="true" canRunAsynchronuously="true"/>
    </CoSimulation_StandAlone>
  </Implementation>)",
                             "");
  const auto config =
      fmt::format(R"({{"step": 1, "stop_time": 1, "instances": {{"a": {{"fmu": "{}"}}}}, "connections": []}})",
                  fmu.path().string());
  EXPECT_THAT(test::input_error([&] { TestRun run(config); }), HasSubstr("model exchange of FMI 1.0"));
}

TEST(Fmi1, GivesNoticeOfAVariableThatIsLeftOut) {
  const test::ChangedFmu fmu("tank1", R"(name="start" valueReference="5")", R"(name="rate" valueReference="5")");
  TestRun run(fmt::format(R"({{"step": 1, "stop_time": 1, "instances": {{"a": {{"fmu": "{}"}}}}, "connections": []}})",
                          fmu.path().string()));
  EXPECT_THAT(run.system.notices, Contains(HasSubstr("an earlier variable also has the name \"rate\"")));
}

}  // namespace
}  // namespace mebots::master
