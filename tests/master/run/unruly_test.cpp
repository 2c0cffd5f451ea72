// SPDX-License-Identifier: Apache-2.0
// Tests early returns, events and faults of FMUs of FMI 3.0, with tests/fmus/unruly.cpp and the clocks of
// metronome.cpp. The fault occurs at 0.5 s.
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace mebots::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A fault of unruly.cpp and its message.
struct Case {
  int fault;
  std::string text;
};

void PrintTo(const Case& one, std::ostream* out) {
  *out << "fault " << one.fault;
}

/// The second value is true if the instances run in separate processes.
using FaultAndPlace = std::tuple<Case, bool>;

class Unruly : public testing::Test {
 protected:
  Unruly() {
    write_file(folder.path() / "two.json", fmt::format(R"({{"step": 0.1, "stop_time": 1, "instances": {{
      "a": {{"fmu": "{0}"}}, "b": {{"fmu": "{0}"}}}}, "connections": [], "record": {{"variables": ["*", "b.blob", "b.bulk"]}}}})",
                                                       UNRULY_FMU));
  }

  ProgramResult run(const std::vector<std::string>& sets, bool isolated, const std::string& config = "two.json") const {
    std::vector<std::string> arguments{"run", config, "--out", "out"};
    for (const auto& set : sets) arguments.insert(arguments.end(), {"--set", set});
    if (isolated) arguments.emplace_back("--isolate");
    return run_program(arguments, folder.path());
  }
  std::string result(const std::string& file) const { return read_file(folder.path() / "out" / file); }
  nlohmann::json summary() const { return nlohmann::json::parse(result("summary.json")); }

  modeldesc::TemporaryFolder folder{"mebots-test"};
};

class UnrulyFaults : public Unruly, public testing::WithParamInterface<FaultAndPlace> {};

TEST_P(UnrulyFaults, EndTheRunWithTheNameAndTheResultsBeforeThem) {
  const auto& [one, isolated] = GetParam();
  const auto ended = run({fmt::format("b.fault={}", one.fault)}, isolated);
  EXPECT_EQ(ended.code, 1) << ended.err;
  EXPECT_THAT(ended.err, AllOf(HasSubstr("instance 'b'"), HasSubstr(one.text)));
  EXPECT_EQ(summary()["outcome"], "failed");
  EXPECT_THAT(summary()["error"].get<std::string>(), AllOf(HasSubstr("instance 'b'"), HasSubstr(one.text)));
  EXPECT_THAT(result("results.csv"), HasSubstr("\n0.4,")) << "the rows before the fault are kept";
  EXPECT_THAT(result("results.csv"), Not(HasSubstr("\n1,")));
}

INSTANTIATE_TEST_SUITE_P(
    All, UnrulyFaults,
    testing::Combine(testing::Values(Case{2, "returned early at 0.5 s 1000 times in a row"},
                                     Case{3, "returned early at 0.4 s, but the step was from 0.5 s to 0.6 s"},
                                     Case{4, "returned early at 0.7 s, but the step was from 0.5 s to 0.6 s"},
                                     Case{5, "returned early at nan s"},
                                     Case{6, "requested another update 1000 times in a row: the event does not end"},
                                     Case{7, "bytes for 'blob', which has at most 16384"},
                                     Case{8, "returned 2147483648 bytes for 'bulk', which has at most 1073741824"},
                                     Case{9, "bytes of 'bulk', which cannot be read"},
                                     Case{10, "wrote more than the 2 values of 'y' that were requested"},
                                     Case{11, "y has another number of elements"}),
                     testing::Bool()));

TEST_F(Unruly, EarlyReturnsAndEventsKeepTheValuesOfWholeSteps) {
  ASSERT_EQ(run({"b.n=3"}, false).code, 0);
  const auto straight = result("results.csv");
  EXPECT_THAT(straight, HasSubstr("b.y[3]"));
  for (const bool isolated : {false, true}) {
    ASSERT_EQ(run({"a.fault=1", "a.at=0", "b.n=3"}, isolated).code, 0);
    const auto rows = result("results.csv");
    const auto last = rows.substr(rows.rfind('\n', rows.size() - 2) + 1);
    EXPECT_THAT(last, testing::ContainsRegex("^1,(1|0.99999999999999[0-9]*|1.0000000000000[0-9]*),"));
    EXPECT_THAT(last, HasSubstr(",10,")) << "one event per step";
  }
}

TEST_F(Unruly, SizesAndElementsAreSetInAnyOrder) {
  const auto bank = fmt::format(R"({{"step": 0.5, "stop_time": 1, "instances": {{"a": {{"fmu": "{}"}}}},
    "connections": []}})",
                                BANK_FMU);
  write_file(folder.path() / "bank.json", bank);
  ASSERT_EQ(run({"a.lines=4", "a.line.u[4]=7"}, false, "bank.json").code, 0);
  const auto rows = result("results.csv");
  EXPECT_THAT(rows, HasSubstr("a.line.y[4]"));
  ASSERT_EQ(run({"a.line.u[4]=7", "a.lines=4"}, false, "bank.json").code, 0);
  EXPECT_EQ(result("results.csv"), rows);
  const auto gone = run({"a.lines=4", "a.line.u[4]=7", "a.lines=3"}, false, "bank.json");
  EXPECT_EQ(gone.code, 2);
  EXPECT_THAT(gone.err, HasSubstr("has no variable 'line.u[4]'"));
}

TEST_F(Unruly, ClocksThatTickWithoutEndAreReported) {
  write_file(folder.path() / "clock.json", fmt::format(R"({{"step": 0.1, "stop_time": 1, "instances": {{
      "a": {{"fmu": "{0}"}}, "b": {{"fmu": "{0}"}}}}, "connections": []}})",
                                                       METRONOME_FMU));
  for (const bool isolated : {false, true}) {
    const auto ended = run({"b.endless=true"}, isolated, "clock.json");
    EXPECT_EQ(ended.code, 1);
    EXPECT_THAT(ended.err, HasSubstr("'b': the clocks of its group tick at 0.17 s without end"));
    EXPECT_EQ(summary()["outcome"], "failed");
    EXPECT_THAT(result("results.csv"), HasSubstr("\n0.1,"));
  }
}

}  // namespace
}  // namespace mebots::test
