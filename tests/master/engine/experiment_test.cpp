// SPDX-License-Identifier: Apache-2.0
// Tests arguments of fmi2SetupExperiment, and values that are valid in C but not in FMI, with tests/fmus/experiment.c.
#include "io/config/load_system.hpp"
#include "mebots/mission.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

namespace mebots::master {
namespace {

using test::TestRun;
using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// Returns a config with one instance `a`, from 1 s to 3 s in steps of 0.5 s.
std::string config_of(const std::string& keys, const std::string& fmu = EXPERIMENT_FMU) {
  return fmt::format(R"({{"step": 0.5, "start_time": 1, "stop_time": 3, "connections": [],
                         "instances": {{"a": {{"fmu": "{}"{}}}}}}})",
                     fmu, keys);
}

std::map<std::string, double> arguments_of(const std::string& keys, const std::string& fmu = EXPERIMENT_FMU) {
  TestRun run(config_of(keys, fmu));
  run.to_end();
  std::map<std::string, double> arguments;
  for (const std::string name : {"start", "stop", "has_stop", "tolerance", "has_tolerance"}) {
    arguments[name] = run.column("a." + name).back();
  }
  return arguments;
}

using Arguments = std::map<std::string, double>;

TEST(SetupExperiment, PassesNoStopTimeAndTheDefaultTolerance) {
  EXPECT_EQ(arguments_of(""),
            (Arguments{{"start", 1}, {"stop", 0}, {"has_stop", 0}, {"tolerance", 0.0625}, {"has_tolerance", 1}}));
}

TEST(SetupExperiment, PassesWhatTheConfigRequests) {
  EXPECT_EQ(arguments_of(R"(, "pass_stop_time": true, "tolerance": 0.03125)"),
            (Arguments{{"start", 1}, {"stop", 3}, {"has_stop", 1}, {"tolerance", 0.03125}, {"has_tolerance", 1}}));
  EXPECT_EQ(arguments_of(R"(, "pass_stop_time": false, "tolerance": false)"),
            (Arguments{{"start", 1}, {"stop", 0}, {"has_stop", 0}, {"tolerance", 0}, {"has_tolerance", 0}}));
}

TEST(SetupExperiment, PassesTheSameToAProcessOfItsOwn) {
  if (!test::sandbox_refusal().empty()) GTEST_SKIP() << test::sandbox_refusal();
  EXPECT_EQ(arguments_of(R"(, "process": "own", "pass_stop_time": true)"),
            (Arguments{{"start", 1}, {"stop", 3}, {"has_stop", 1}, {"tolerance", 0.0625}, {"has_tolerance", 1}}));
  EXPECT_EQ(arguments_of(R"(, "process": "sandboxed", "tolerance": false)"),
            (Arguments{{"start", 1}, {"stop", 0}, {"has_stop", 0}, {"tolerance", 0}, {"has_tolerance", 0}}));
}

TEST(SetupExperiment, ValuesAreThoseOfTheArguments) {
  // Euler's method with steps of 1/16 s: x = (15/16)^(16 t).
  TestRun run(config_of(""));
  run.to_end();
  EXPECT_THAT(run.column("a.clock"), ElementsAre(1, 1.5, 2, 2.5, 3));
  const auto x = run.column("a.x");
  for (std::size_t k = 0; k < x.size(); ++k) {
    EXPECT_NEAR(x[k], std::pow(15.0 / 16, 8 * static_cast<double>(k)), 1e-15) << "32 roundings of 2^-53";
  }
  TestRun jumps(config_of(R"(, "pass_stop_time": true)"));
  jumps.to_end();
  EXPECT_THAT(jumps.column("a.clock"), ElementsAre(1, 3, 3, 3, 3));
  TestRun coarse(config_of(R"(, "tolerance": 0.5)"));
  EXPECT_THAT(coarse.to_end().column("a.x"), ElementsAre(1, 0.5, 0.25, 0.125, 0.0625));
}

TEST(SetupExperiment, DoesNotPassAnInvalidDefaultTolerance) {
  for (const std::string bad : {"0", "-1e-6", "INF", "NaN"}) {
    const test::ChangedFmu fmu("experiment", R"(tolerance="0.0625")", fmt::format(R"(tolerance="{}")", bad));
    EXPECT_EQ(arguments_of("", fmu.path().string())["has_tolerance"], 0) << bad;
    TestRun run(config_of("", fmu.path().string()));
    EXPECT_THAT(run.system.notices, Contains(HasSubstr("a: its FMU has a default tolerance of"))) << bad;
    EXPECT_EQ(arguments_of(R"(, "tolerance": 0.25)", fmu.path().string())["tolerance"], 0.25) << bad;
  }
}

TEST(SetupExperiment, MistakenKeysAreRefusedWithTheirPlace) {
  const auto refusal = [](const std::string& keys) { return test::input_error([&] { TestRun run(config_of(keys)); }); };
  EXPECT_THAT(refusal(R"(, "tolerance": 0)"), HasSubstr("/instances/a/tolerance: "));
  EXPECT_THAT(refusal(R"(, "tolerance": true)"),
              HasSubstr("/instances/a/tolerance: write a number above 0, or false to pass no tolerance"));
  EXPECT_THAT(refusal(R"(, "tolerance": "1e-6")"), HasSubstr("/instances/a/tolerance: "));
  EXPECT_THAT(refusal(R"(, "pass_stop_time": 1)"), HasSubstr("/instances/a/pass_stop_time: "));
}

TEST(SetupExperiment, KeysSurviveTheWayThroughAnSsp) {
  modeldesc::TemporaryFolder folder("mebots-test");
  test::write_file(folder.path() / "c.json", config_of(R"(, "pass_stop_time": true, "tolerance": 0.25)"));
  ASSERT_EQ(test::run_program({"convert", "c.json", "c.ssp"}, folder.path()).code, 0);
  ASSERT_EQ(test::run_program({"run", "c.ssp", "--out", "out"}, folder.path()).code, 0);
  const auto summary = read_config(folder.path() / "c.ssp");
  EXPECT_TRUE(summary.instances.front().pass_stop_time);
  EXPECT_EQ(summary.instances.front().tolerance, 0.25);
}

/// Returns a config in which `b` receives a Boolean of `a`, and `p` a text of `a`.
std::string pair_config(const std::string& process) {
  return fmt::format(R"({{"step": 0.5, "stop_time": 1,
    "instances": {{"a": {{"fmu": "{0}", "process": "{1}"}}, "b": {{"fmu": "{0}"}}, "p": {{"fmu": "PROBE"}}}},
    "connections": [{{"from": "a.flag_out", "to": "b.flag_in"}}, {{"from": "a.flag_out", "to": "p.integer_in"}},
                    {{"from": "a.text", "to": "p.string_in"}}],
    "record": {{"variables": ["*.flag_*", "p.integer_out", "a.text", "p.string_out"], "texts": true,
                "format": "both"}},
    "summary": {{"text": "a.text", "flag": "a.flag_out"}}}})",
                     EXPERIMENT_FMU, process);
}

TEST(Booleans, AreOneOrZeroWhateverNumberAnFmuUses) {
  for (const std::string process : {"shared", "own"}) {
    TestRun run(pair_config(process));
    run.to_end();
    EXPECT_THAT(run.column("a.flag_out"), Each(1)) << process;
    EXPECT_THAT(run.column("b.flag_seen"), Each(1)) << process;
    EXPECT_THAT(run.column("p.integer_out"), Each(2)) << process;
  }
}

TEST(Texts, AreReplacedInResultsIfTheyAreNotUtf8) {
  for (const std::string process : {"shared", "own"}) {
    modeldesc::TemporaryFolder folder("mebots-test");
    test::write_file(folder.path() / "c.json", test::with_probe(pair_config(process)));
    const auto run = test::run_program({"run", "c.json", "--out", "out"}, folder.path());
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out + run.err,
                HasSubstr("the text of 'text' at 0 s is not UTF-8, which FMI demands; the results have \"caf\uFFFD\""));
    const auto csv = test::read_file(folder.path() / "out/results.csv");
    EXPECT_THAT(csv, AllOf(HasSubstr(",caf\uFFFD"), HasSubstr("caf\uFFFD!"), Not(HasSubstr("\xe9,"))));
    EXPECT_THAT(test::read_file(folder.path() / "out/summary.json"), HasSubstr("\"text\": \"caf\uFFFD\""));
    const auto hdf5 = test::read_file(folder.path() / "out/results.h5");
    EXPECT_THAT(hdf5, AllOf(HasSubstr("caf\uFFFD"), Not(HasSubstr("caf\xe9"))));
  }
}

TEST(Texts, ReachAProgramAsUtf8) {
  modeldesc::TemporaryFolder folder("mebots-test");
  test::write_file(folder.path() / "c.json", config_of(""));
  Mission mission(folder.path() / "c.json");
  mission.start();
  EXPECT_EQ(mission.text("a.text"), "caf\uFFFD");
}

}  // namespace
}  // namespace mebots::master
