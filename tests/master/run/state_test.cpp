// SPDX-License-Identifier: Apache-2.0
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace mebots::master {
namespace {

using test::TestRun;
using testing::ElementsAre;
using testing::HasSubstr;

// A system with all kinds of saved state: two step sizes, a buffer, a stop condition with a duration, and an outcome
// with `ever`.
constexpr const char* kSystem = R"({"step": 0.01, "stop_time": 3, "instances": {
    "a": {"fmu": "PROBE", "parameters": {"gain": -0.9, "offset": 0.3}},
    "b": {"fmu": "PROBE", "parameters": {"gain": 0.8}, "step": 0.03}},
  "connections": [{"from": "a.real_out", "to": "b.real_in"}, {"from": "b.real_out", "to": "a.real_in"},
                  {"from": "a.buffer", "to": "b.taken"}, {"from": "a.steps", "to": "b.integer_in"}],
  "stop_when": [{"variable": "a.steps", "above": 100, "for": 1}],
  "outcomes": [{"outcome": "seen", "when": [{"variable": "a.steps", "equals": 100, "ever": true}]}]})";

void step_to(TestRun& run, std::int64_t steps) {
  while (run.simulation().steps_done() < steps && run.simulation().step()) {
  }
}

TEST(State, ARunRestoredFromTheMiddleGivesTheSameBytes) {
  TestRun straight(kSystem);
  straight.to_end();

  TestRun run(kSystem);
  run.initialize();
  step_to(run, 151);  // b is in the middle of its step
  const auto state = run.simulation().save_state();
  step_to(run, 180);
  EXPECT_FALSE(run.simulation().ended());
  run.simulation().restore_state(state);
  EXPECT_EQ(run.simulation().steps_done(), 151);
  step_to(run, 1000);
  EXPECT_EQ(run.csv(), straight.csv());
  EXPECT_EQ(run.simulation().end().text, straight.simulation().end().text);
  EXPECT_EQ(run.outcomes->outcome(), "seen");
}

TEST(State, AStateTravelsAsBytes) {
  TestRun straight(kSystem);
  straight.to_end();

  std::vector<std::byte> bytes;
  {
    TestRun run(kSystem);
    run.initialize();
    step_to(run, 90);
    bytes = run.simulation().serialize(run.simulation().save_state());
  }
  TestRun other(kSystem);
  other.initialize();
  const auto state = other.simulation().deserialize(bytes);
  step_to(other, 200);
  other.simulation().restore_state(state);
  step_to(other, 1000);
  EXPECT_EQ(other.csv(), straight.csv());
}

TEST(State, ConditionsOnGroupsRememberWhatHeldBefore) {
  // All conditions become true before step 90. Those with `ever` are false at the end.
  const auto config = std::string(kSystem).substr(0, std::string_view(kSystem).find(R"("stop_when")")) + R"(
      "stop_when": [{"for": 1.5, "all": [{"variable": "a.steps", "above": 50},
          {"any": [{"variable": "b.steps", "above": 10}, {"variable": "b.steps", "below": 0}]}]}],
      "outcomes": [{"outcome": "seen", "when": [
          {"any": [{"variable": "a.steps", "equals": 20}, {"variable": "a.steps", "equals": -1}], "ever": true},
          {"count": [{"variable": "a.steps", "equals": 10, "ever": true}, {"variable": "b.steps", "equals": 3, "ever": true},
                     {"variable": "a.steps", "equals": -1, "ever": true}], "equals": 2}]}]})";
  TestRun straight(config);
  straight.to_end();
  EXPECT_THAT(straight.simulation().end().text, HasSubstr("at 0.51 s, held for 1.5 s"));

  TestRun begun(config);
  begun.initialize();
  step_to(begun, 90);
  TestRun resumed(config);
  resumed.initialize();
  const auto bytes = begun.simulation().serialize(begun.simulation().save_state());
  resumed.simulation().restore_state(resumed.simulation().deserialize(bytes));
  step_to(resumed, 1000);
  EXPECT_EQ(resumed.simulation().steps_done(), straight.simulation().steps_done());
  EXPECT_EQ(resumed.simulation().end().text, straight.simulation().end().text);
  EXPECT_EQ(straight.outcomes->outcome(), "seen");
  EXPECT_EQ(resumed.outcomes->outcome(), "seen");
}

TEST(State, AnFmuHearsThatItMayBeSetBackOnlyWhereThatCanHappen) {
  // If noSetFMUStatePriorToCurrentPoint is false, libcosim's quarter truck does not advance.
  const auto set_backs = [](const std::string& more, bool keep) {
    TestRun run(fmt::format(
        R"({{"step": 0.1, "stop_time": 0.4, "instances": {{"a": {{"fmu": "PROBE"{}}}}}, "connections": [], "record": ["a.set_backs"]}})",
        more));
    run.initialize();
    step_to(run, 1);
    auto state = run.simulation().save_state();
    if (!keep) state = {};
    step_to(run, 3);
    state = {};
    step_to(run, 4);
    return run.column("a.set_backs");
  };
  for (const char* process : {"", R"(, "process": "own")"}) {
    EXPECT_THAT(set_backs(process, false), ElementsAre(0, 0, 0, 0, 0)) << process;
    EXPECT_THAT(set_backs(process, true), ElementsAre(0, 0, 1, 2, 2)) << process;
    EXPECT_THAT(set_backs(std::string(R"(, "on_discard": "divide")") + process, false), ElementsAre(0, 1, 2, 3, 4));
  }
}

TEST(State, AStateOfBeforeAStepThatWasTakenWithoutOneIsRefused) {
  // The steps promise the FMU that no earlier state will be restored. The FMU may therefore have discarded the data of
  // these states.
  TestRun run(kSystem);
  run.initialize();
  const auto bytes = run.simulation().serialize(run.simulation().save_state());
  step_to(run, 3);
  EXPECT_THROW(run.simulation().restore_state(run.simulation().deserialize(bytes)), Error);
}

TEST(State, AStateOfAnotherEnsembleIsRefused) {
  TestRun one(R"({"step": 0.1, "stop_time": 1, "instances": {"a": {"fmu": "PROBE"}}, "connections": []})");
  one.initialize();
  const auto state = one.simulation().save_state();
  const auto bytes = one.simulation().serialize(state);
  TestRun two(kSystem);
  two.initialize();
  EXPECT_THROW(two.simulation().restore_state(state), Error);
  EXPECT_THROW(two.simulation().deserialize(bytes), Error);
}

}  // namespace
}  // namespace mebots::master
