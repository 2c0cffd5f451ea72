// SPDX-License-Identifier: Apache-2.0
// Tests FMUs without a config: their times, recorded variables and names.
#include "base/time.hpp"
#include "io/config/load_system.hpp"
#include "mebots/mission.hpp"
#include "test_system.hpp"

#include <gmock/gmock.h>

namespace mebots::master {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kExperiment = R"(<DefaultExperiment startTime="0" stopTime="1" stepSize="0.1"/>)";

/// Returns start time, stop time and step in seconds for a probe with this DefaultExperiment.
std::vector<double> times(const std::string& experiment, const GivenTimes& given = {}) {
  const test::ChangedFmu fmu("probe", kExperiment, experiment);
  const auto system = read_config(fmu.path(), given);
  return {to_seconds(system.start_time_ns), to_seconds(system.stop_time_ns), to_seconds(system.step)};
}

std::vector<std::string> notices(const std::string& experiment, const GivenTimes& given = {}) {
  const test::ChangedFmu fmu("probe", kExperiment, experiment);
  return read_config(fmu.path(), given).notices;
}

TEST(SingleFmu, TimesComeFromTheDefaultExperiment) {
  EXPECT_THAT(times(kExperiment), ElementsAre(0, 1, 0.1));
  EXPECT_THAT(times(R"(<DefaultExperiment startTime="2" stopTime="5" stepSize="0.5"/>)"), ElementsAre(2, 5, 0.5));
  EXPECT_THAT(notices(kExperiment),
              Contains(AllOf(HasSubstr("from 0 s (DefaultExperiment"), HasSubstr("to 1 s (DefaultExperiment"),
                             HasSubstr("step of 0.1 s (DefaultExperiment"))));
}

TEST(SingleFmu, TimesThatTheFmuDoesNotStateHaveDefaults) {
  EXPECT_THAT(times(""), ElementsAre(0, 1, 0.002));
  EXPECT_THAT(times("<DefaultExperiment/>"), ElementsAre(0, 1, 0.002));
  EXPECT_THAT(times(R"(<DefaultExperiment stopTime="10"/>)"), ElementsAre(0, 10, 0.02));
  EXPECT_THAT(times(R"(<DefaultExperiment startTime="3"/>)"), ElementsAre(3, 4, 0.002));
  EXPECT_THAT(times(R"(<DefaultExperiment stepSize="0.25"/>)"), ElementsAre(0, 1, 0.25));
  EXPECT_THAT(notices(""), Contains(AllOf(HasSubstr("from 0 s (by default"), HasSubstr("to 1 s (by default"),
                                          HasSubstr("1/500 of the run"))));
}

TEST(SingleFmu, StepsMayBeRatios) {
  EXPECT_THAT(times(R"(<DefaultExperiment stopTime="1" stepSize="0.016666666666666666"/>)"),
              ElementsAre(0, 1, 1.0 / 60));
  EXPECT_THAT(times(R"(<DefaultExperiment stopTime="1" stepSize="0.016666"/>)"), ElementsAre(0, 0.99996, 0.016666));
  EXPECT_THAT(times(R"(<DefaultExperiment stopTime="1" stepSize="0.01666666667"/>)"),
              ElementsAre(0, DoubleNear(0.983333353, 1e-15), 0.016666667));
  EXPECT_THAT(times("", {"1/60", 2}), ElementsAre(0, 2, 1.0 / 60));
  EXPECT_THAT(times(R"(<DefaultExperiment startTime="-1"/>)"), ElementsAre(-1, 0, 0.002));
  EXPECT_THAT(times(R"(<DefaultExperiment stopTime="0.00001234"/>)"),
              ElementsAre(0, DoubleNear(514 * 24e-9, 1e-21), DoubleNear(24e-9, 1e-22)))
      << "a part in 500, 24.68 ns, is neither a whole number of nanoseconds nor a ratio that a grid can have";
}

TEST(SingleFmu, TimesThatMakeNoRunAreNotTaken) {
  EXPECT_THAT(times(R"(<DefaultExperiment startTime="1" stopTime="1"/>)"), ElementsAre(1, 2, 0.002));
  EXPECT_THAT(times(R"(<DefaultExperiment stopTime="1e300"/>)"), ElementsAre(0, 1, 0.002));
  EXPECT_THAT(times(R"(<DefaultExperiment stopTime="1" stepSize="3"/>)"), ElementsAre(0, 1, 0.002));
  EXPECT_THAT(times(R"(<DefaultExperiment stopTime="1" stepSize="0"/>)"), ElementsAre(0, 1, 0.002));
}

TEST(SingleFmu, ADefaultStopTimeIsRoundedDownToWholeSteps) {
  EXPECT_THAT(times(R"(<DefaultExperiment stopTime="1" stepSize="0.3"/>)"),
              ElementsAre(0, DoubleNear(0.9, 1e-15), 0.3));
  EXPECT_THAT(notices(R"(<DefaultExperiment stopTime="1" stepSize="0.3"/>)"),
              Contains(AllOf(HasSubstr("to 0.9 s"), HasSubstr("1 s rounded to a whole number of steps"))));
}

TEST(SingleFmu, GivenTimesWin) {
  EXPECT_THAT(times(kExperiment, {0.25, 2}), ElementsAre(0, 2, 0.25));
  EXPECT_THAT(times("", {std::nullopt, 5}), ElementsAre(0, 5, 0.01));
  EXPECT_THAT(times("", {0.3, std::nullopt}), ElementsAre(0, DoubleNear(0.9, 1e-15), 0.3));
  EXPECT_THAT(notices(kExperiment, {0.25, 2}),
              Contains(AllOf(HasSubstr("2 s (--stop-time)"), HasSubstr("0.25 s (--step)"))));
  // A stop time that the user gives is not changed. If it is not a multiple of the step, it is rejected.
  EXPECT_THAT(test::input_error([] {
                times(kExperiment, {std::nullopt, 0.25});
              }),
              HasSubstr("not a multiple of the step 0.1 s"));
}

TEST(SingleFmu, RunsFromTheCommandLine) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  std::filesystem::copy(PROBE_FMU, folder.path() / "thing.fmu");
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"run", "thing.fmu", "--out", "out"});
    return test::run_program(more, folder.path());
  };
  const auto result = run({"--set", "gain=2", "--set", "thing.real_in=3"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out + result.err, HasSubstr("runs alone from 0 s"));
  const auto csv = test::read_file(folder.path() / "out" / "results.csv");
  EXPECT_THAT(csv, HasSubstr("thing.real_out [metre]"));
  EXPECT_THAT(csv, HasSubstr("\n1,6,"));

  test::write_file(folder.path() / "in.csv", "time,real_in\n0,0\n1,10\n");
  EXPECT_EQ(run({"--inputs", "in.csv", "--record", "thing.integral", "--step", "0.5", "--isolate"}).code, 0);
  EXPECT_EQ(test::read_file(folder.path() / "out" / "results.csv"),
            "time [s],thing.integral [m.s]\n0,0\n0.5,0\n1,2.5\n");

  const auto wrong = run({"--set", "gian=2"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("'gain'"));
  EXPECT_EQ(run({"--stop-time", "0.25"}).code, 2);
}

TEST(SingleFmu, ResumesFromACheckpointToTheSameBits) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  std::filesystem::copy(PROBE_FMU, folder.path() / "thing.fmu");
  const std::string signal = "time,real_in\n0,0\n0.35,1\n0.35,2\n1,10\n";
  test::write_file(folder.path() / "in.csv", signal);
  // If the folder in string_in does not exist, the probe creates it and interrupts the run. Thus only the first run is
  // interrupted.
  const auto run = [&](const std::string& out) {
    return test::run_program({"run", "thing.fmu", "--inputs", "in.csv", "--out", out, "--checkpoint-every", "0.2",
                              "--set", "fault=interrupt", "--set", "fault_time=0.6", "--set", "string_in=once"},
                             folder.path());
  };
  EXPECT_EQ(run("resumed").code, 1);
  EXPECT_EQ(run("straight").code, 0);
  test::write_file(folder.path() / "in.csv", "time,real_in\n0,0\n1,10\n");
  const auto refused = test::run_program({"resume", "resumed"}, folder.path());
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("in.csv"));
  test::write_file(folder.path() / "in.csv", signal);
  EXPECT_EQ(test::run_program({"resume", "resumed"}, folder.path()).code, 0);
  const auto results = [&](const std::string& out) { return test::read_file(folder.path() / out / "results.csv"); };
  EXPECT_EQ(results("resumed"), results("straight"));
  EXPECT_THAT(results("straight"), HasSubstr("\n1,"));
}

TEST(SingleFmu, AnFmuWithoutOutputsHasItsLocalVariablesRecorded) {
  modeldesc::ModelDescription description;
  description.variables.resize(1);
  description.variables[0].name = "x";
  std::vector<std::string> notices;
  const auto config = config::single_fmu_config("thing.fmu", description, {}, notices);
  EXPECT_EQ(config.at("record").dump(), R"({"locals":true})");
  EXPECT_THAT(notices, Contains(HasSubstr("no outputs")));
  description.variables[0].causality = modeldesc::Causality::output;
  EXPECT_FALSE(config::single_fmu_config("thing.fmu", description, {}, notices).contains("record"));
}

TEST(SingleFmu, LocalVariablesAreRecordedWhereTheConfigAsks) {
  test::TestRun run(R"({"step": 0.1, "stop_time": 0.1, "instances": {"a": {"fmu": "PROBE"}}, "connections": [],
                        "record": {"locals": true, "variables": ["a.*s"]}})");
  EXPECT_THAT(run.to_end().csv(), testing::StartsWith("time [s],a.steps [-],a.set_backs [-]\n"));
}

TEST(SingleFmu, IsAMission) {
  Mission mission(PROBE_FMU);
  mission.set("gain", 3.0);
  mission.set("probe.offset", 1.0);
  mission.write("real_in", 2);
  mission.run();
  EXPECT_EQ(mission.value("real_out"), 7);
  EXPECT_EQ(mission.time_s(), 1);
  EXPECT_EQ(mission.series("probe.real_out").values.back(), 7);
}

}  // namespace
}  // namespace mebots::master
