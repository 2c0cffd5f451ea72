// SPDX-License-Identifier: Apache-2.0
// Tests co-simulation of FMI 3.0 with tests/fmus/bank, integrators whose number is a structural parameter.
#include "cases/run_case.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <string>

namespace mebots::master {
namespace {

using test::TestRun;
using testing::ElementsAre;
using testing::HasSubstr;

/// Returns a config of two banks, "a" and "b". `parameters` belong to "a".
std::string banks(const std::string& parameters, const std::string& connections = "", const std::string& more = "") {
  return fmt::format(R"({{"step": 0.5, "stop_time": 1, "instances": {{
    "a": {{"fmu": "{0}", "parameters": {{{1}}}{3}}}, "b": {{"fmu": "{0}", "parameters": {{"lines": 3}}{3}}}}},
    "connections": [{2}]}})",
                     BANK_FMU, parameters, connections, more);
}

std::string banks_refused(const std::string& config) {
  return test::input_error([&] { TestRun run(config); });
}

const std::string kThree = R"("lines": 3, "line.initial[2]": 7, "line.u[1]": 2, "line.u[3]": -2)";

TEST(Fmi3CoSimulation, IntegratesArraysOfTheConfiguredSize) {
  TestRun run(banks(kThree));
  run.to_end();
  EXPECT_THAT(run.column("a.line.y[1]"), ElementsAre(0, 1, 2));
  EXPECT_THAT(run.column("a.line.y[3]"), ElementsAre(20, 19, 18)) << "the other elements keep their start values";
  EXPECT_THAT(run.column("a.line.y[2]"), ElementsAre(7, 7, 7));
}

TEST(Fmi3CoSimulation, ConnectsArraysWholeAndByElement) {
  TestRun whole(banks(kThree, R"({"from": "a.line.y", "to": "b.line.u", "convert_units": false})"));
  TestRun single(banks(kThree, R"({"from": "a.line.y[2]", "to": "b.line.u[2]", "convert_units": false})"));
  EXPECT_THAT(whole.to_end().column("b.line.y[2]"), ElementsAre(10, 13.5, 17));
  EXPECT_EQ(single.to_end().column("b.line.y[2]"), whole.column("b.line.y[2]"));
  EXPECT_THAT(single.column("b.line.y[3]"), ElementsAre(20, 20, 20));
}

TEST(Fmi3CoSimulation, PassesBinariesOn) {
  TestRun run(banks(R"("line.message[1]": "0aff00")", R"({"from": "a.line.echo[1]", "to": "b.line.message[1]"})"));
  EXPECT_THAT(run.to_end().column("b.far.bytes"), ElementsAre(0, 0, 3));
}

TEST(Fmi3CoSimulation, AConditionComparesTheBytesOfABinary) {
  auto config = banks(R"("line.message[1]": "0aff00")");
  config.insert(config.rfind('}'), R"(, "stop_when": [{"variable": "a.line.echo[1]", "equals": "0aff00"}])");
  TestRun run(config);
  run.to_end();
  EXPECT_EQ(run.simulation().end().text, "a.line.echo[1] = \"0aff00\" at 0.5 s");
}

TEST(Fmi3CoSimulation, ACaseComparesElementsAndBinaries) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  test::write_file(folder.path() / "cases.json", R"({"cases": {"one": {"expected": "out.csv",
    "parameters": {"lines": 3, "line.u[3]": 2, "line.message[3]": "0aff00"}}}})");
  const auto verdict = [&](const std::string& bytes) {
    test::write_file(folder.path() / "out.csv", "time,line.y[3],line.echo[3]\n1,22," + bytes + "\n");
    return cases::run_case(BANK_FMU, cases::read_cases(folder.path() / "cases.json").cases.at(0), {}).text();
  };
  EXPECT_EQ(verdict("0aff00"), "1 rows of 2 variables");
  EXPECT_THAT(verdict("0a"), HasSubstr("line.echo[3] is '0aff00', expected '0a'"));
}

TEST(Fmi3CoSimulation, HasTheSameBitsInAProcessOfItsOwn) {
  const std::string connection = R"({"from": "a.line.y", "to": "b.line.u", "convert_units": false})";
  TestRun here(banks(kThree, connection));
  TestRun there(banks(kThree, connection, R"(, "process": "own")"));
  EXPECT_EQ(there.to_end().column("b.line.y[1]"), here.to_end().column("b.line.y[1]"));
}

/// Returns a config of tests/fmus/follower.cpp, whose inputs have slopes of 2 and -4 from a file.
std::string follower(const std::string& folder, const std::string& more = "") {
  test::write_file(std::filesystem::path(folder) / "u.csv", "time,f.u[1],f.u[2]\n0,0,1\n2,4,-7\n");
  return fmt::format(R"({{"step": 0.5, "stop_time": 2, "instances": {{"f": {{"fmu": "{}"{}}}}},
    "inputs": {{"file": "{}/u.csv"}}}})",
                     FOLLOWER_FMU, more, folder);
}

TEST(Fmi3CoSimulation, GivesInputsWithinAStepToAnFmuThatCallsBack) {
  modeldesc::TemporaryFolder folder{"mebots-test"};
  TestRun run(follower(folder.path()));
  const auto x = run.to_end().column("f.x[1]");
  ASSERT_EQ(x.size(), 5U);
  for (int k = 0; k < 5; ++k) {
    const double t = 0.5 * k;
    EXPECT_NEAR(x[static_cast<std::size_t>(k)], t * t, 1e-12) << "the integral of 2 t";
    EXPECT_NEAR(run.column("f.x[2]")[static_cast<std::size_t>(k)], t - 2 * t * t, 1e-12);
  }
  EXPECT_EQ(run.column("f.updates").back(), 40);
  TestRun own(follower(folder.path(), R"(, "process": "own")"));
  EXPECT_EQ(own.to_end().column("f.x[2]"), run.column("f.x[2]"));
}

TEST(Fmi3CoSimulation, ReportsAnInputThatIsRefusedWithinAStep) {
  modeldesc::TemporaryFolder folder{"mebots-test"};
  TestRun run(follower(folder.path(), R"(, "parameters": {"limit": 2.5})"));
  try {
    run.to_end();
    FAIL() << "u[1] exceeds the limit at 1.25 s";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("fmi3SetFloat64 within a step"));
  }
}

TEST(Fmi3CoSimulation, RefusesArraysOfOtherSizes) {
  EXPECT_THAT(
      banks_refused(banks(R"("lines": 2)", R"({"from": "a.line.y", "to": "b.line.u", "convert_units": false})")),
      HasSubstr("an array up to [2], but b.line.u is an array up to [3]"));
  EXPECT_THAT(banks_refused(banks(R"("lines": 9)")), HasSubstr("above the maximum"));
}

}  // namespace
}  // namespace mebots::master
