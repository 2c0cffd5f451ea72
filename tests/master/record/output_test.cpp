// SPDX-License-Identifier: Apache-2.0
#include "base/sha256.hpp"
#include "record/recorder.hpp"
#include "run/input_hash.hpp"
#include "run/run.hpp"
#include "run/summary.hpp"
#include "support/files.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <charconv>

namespace mebots::master {
namespace {

using test::TestRun;
using testing::HasSubstr;
using testing::StartsWith;

TEST(Recorder, HeaderNamesVariablesAndUnits) {
  TestRun run(R"({"step": 0.1, "stop_time": 0.1, "instances": {"a": {"fmu": "PROBE"}}, "connections": []})");
  run.to_end();
  // Records all Real, Integer, Boolean and enumeration outputs, but no buffers, texts or parameters.
  EXPECT_THAT(
      run.csv(),
      StartsWith(
          "time [s],a.real_out [metre],a.integral [m.s],a.last_end [s],a.integer_out [-],a.mode_out [-],a.colour_out "
          "[-],a.steps [-],a.taken_sum [-],a.boolean_out [-],\"a.odd name, with \"\"comma\"\" [metre]\"\n"
          "0,0,0,0,1,0,0,0,0,1,0\n"));
}

TEST(Recorder, NumbersAreShortAndReadBackToTheSameBits) {
  TestRun run(
      R"({"step": 0.1, "stop_time": 1, "instances": {"a": {"fmu": "PROBE", "parameters": {"real_in": 0.1}}}, "connections": [], "record": ["a.integral"]})");
  run.to_end();
  EXPECT_THAT(run.csv(),
              StartsWith("time [s],a.integral [m.s]\n0,0\n0.1,0.010000000000000002\n0.2,0.020000000000000004\n"));
  double sum = 0;
  for (const double value : run.column("a.integral")) {
    EXPECT_EQ(value, sum);
    sum += 0.1 * 0.1;
  }
}

TEST(Recorder, PatternsAndIntervalChooseWhatIsWritten) {
  TestRun run(
      R"({"step": 0.1, "stop_time": 0.9, "instances": {"a": {"fmu": "PROBE"}, "b": {"fmu": "PROBE"}}, "connections": [],
                  "record": {"variables": ["?.ste*", "a.last_step"], "interval": 0.4}})");
  run.to_end();
  EXPECT_EQ(run.csv(),
            "time [s],a.last_step [s],a.steps [-],b.steps [-]\n0,0,0,0\n0.4,0.1,4,4\n0.8,0.1,8,8\n0.9,0.1,9,9\n");
}

TEST(Recorder, PatternsFit) {
  EXPECT_TRUE(fits("motors.rotor[1].thrust", "motors.*"));
  EXPECT_TRUE(fits("motors.rotor[1].thrust", "*.rotor[?].thrust"));
  EXPECT_TRUE(fits("aXbXc", "a*X?"));
  EXPECT_TRUE(fits("", "*"));
  EXPECT_FALSE(fits("motors.power", "*.powe"));
  EXPECT_FALSE(fits("abc", "a?"));
  EXPECT_FALSE(fits("abc", ""));
}

TEST(Recorder, ExcludedVariablesAndTextsAreTheConfigsChoice) {
  TestRun run(R"({"step": 0.1, "stop_time": 0.1, "instances": {
      "a": {"fmu": "PROBE", "parameters": {"string_in": "one, \"two\"\nthree"}}}, "connections": [],
      "record": {"variables": ["a.s*"], "exclude": ["*.steps"], "texts": true}})");
  run.to_end();
  EXPECT_EQ(run.csv(), "time [s],a.string_out [-]\n0,\"one, \"\"two\"\"\nthree!\"\n0.1,\"one, \"\"two\"\"\nthree!\"\n");
}

TEST(Recorder, AnExclusionThatFitsNothingIsRefused) {
  EXPECT_THAT(test::input_error([] {
                TestRun run(R"({"step": 0.1, "stop_time": 0.1, "instances": {"a": {"fmu": "PROBE"}},
                    "connections": [], "record": {"exclude": ["a.stepz"]}})");
              }),
              testing::AllOf(HasSubstr("/record/exclude/0"), HasSubstr("no recorded variable fits 'a.stepz'"),
                             HasSubstr("a.steps")));
}

TEST(Recorder, AChoiceOfTheRunTakesThePlaceOfTheConfigs) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  const auto config = folder.path() / "test.json";
  RunOptions options;
  options.out = folder.path() / "out";
  test::write_file(config, test::with_probe(R"({"step": 0.1, "stop_time": 0.1, "instances": {"a": {"fmu": "PROBE"}},
                       "connections": [], "record": {"variables": ["a.s*"], "exclude": ["*.steps"]}})"));
  master::Run run(config, options);
  run.record({"a.integer_out", "a.steps"});
  run.run();
  EXPECT_THAT(test::read_file(options.out / "results.csv"), StartsWith("time [s],a.integer_out [-],a.steps [-]\n"));
}

TEST(Recorder, ManyBlocksOfRowsArriveWholeAndInOrder) {
  TestRun run(R"({"step": 0.001, "stop_time": 30, "instances": {
      "a": {"fmu": "PROBE", "parameters": {"real_in": 0.1}}}, "connections": [],
      "record": ["a.steps", "a.integral", "a.last_end"]})");
  run.to_end();
  const auto steps = run.column("a.steps");
  ASSERT_EQ(steps.size(), 30001u);
  EXPECT_EQ(run.recorder->rows(), 30001);
  const auto times = run.column("time");
  for (std::size_t i = 0; i < steps.size(); ++i) {
    ASSERT_EQ(steps[i], static_cast<double>(i));
    ASSERT_EQ(times[i], static_cast<double>(i) / 1000);
  }
}

TEST(Recorder, AFullDiskIsReportedByTheThreadThatSimulates) {
  TestRun run(R"({"step": 0.001, "stop_time": 100, "instances": {"a": {"fmu": "PROBE"}}, "connections": []})");
  OutputFile full("/dev/full");
  run.recorder->add(std::make_unique<CsvSink>(run.recorder->columns(), full));
  EXPECT_THROW(run.to_end(), Error);
}

TEST(ParameterRecorder, WritesEveryParameterOnce) {
  TestRun run(R"({"step": 0.1, "stop_time": 0.2, "instances": {
      "a": {"fmu": "PROBE", "parameters": {"gain": 2.5, "fault": "a, b"}}}, "connections": [],
      "record": {"parameters": ["a.gain", "*.fault*"]}})");
  ParameterRecorder parameters(run.system, run.simulation().ensemble(), run.folder.path() / "parameters.csv");
  run.simulation().add(parameters);
  run.to_end();
  EXPECT_EQ(test::read_file(run.folder.path() / "parameters.csv"),
            "parameter,unit,value\na.gain,,2.5\na.fault_time,s,1\na.fault,,\"a, b\"\n");
}

TEST(Statistics, CountTheCallsToEveryInstance) {
  TestRun plain(R"({"step": 0.1, "stop_time": 1, "instances": {
      "a": {"fmu": "PROBE", "parameters": {"fault": "slow", "fault_time": 0.5}}, "b": {"fmu": "PROBE", "step": 0.5}},
      "connections": []})");
  Statistics statistics;
  SlaveOptions options;
  options.statistics = &statistics;
  Simulation simulation(plain.system, plain.messages, options);
  simulation.initialize();
  while (simulation.step()) {
  }
  ASSERT_EQ(statistics.instances.size(), 2u);
  const auto& a = statistics.instances[0];
  EXPECT_EQ(a.name, "a");
  EXPECT_EQ(a.steps, 10);
  EXPECT_EQ(statistics.instances[1].steps, 2);
  EXPECT_GE(a.slowest_s, 0.02);  // duration of the slow steps
  EXPECT_GE(a.slowest_at_ns, 400'000'000);
  EXPECT_GE(a.time_s, a.step_time_s);
  EXPECT_GT(a.calls, a.steps);
  const auto json = statistics_json(statistics, 10);
  EXPECT_EQ(json["instances"]["a"]["steps"], 10);
  EXPECT_NEAR(json["master"]["share"].get<double>() + json["instances"]["a"]["share"].get<double>() +
                  json["instances"]["b"]["share"].get<double>(),
              1, 1e-12);  // tolerance for rounding
}

TEST(OutputFile, AFullDiskIsReported) {
  OutputFile file("/dev/full");
  file.append("something");
  try {
    file.close();
    FAIL() << "/dev/full takes nothing";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("/dev/full"), HasSubstr("No space left"), HasSubstr("--out")));
  }
}

TEST(OutputFile, AFileThatCannotBeMadeIsBadInput) {
  EXPECT_THAT(test::input_error([] { OutputFile file("/proc/nothing/results.csv"); }), HasSubstr("cannot be written"));
}

TEST(OutputFile, IsTruncatedAndContinues) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  OutputFile file(folder.path() / "x");
  file.append("abcdef");
  file.truncate(2);
  file.append("Z");
  EXPECT_EQ(file.size(), 3u);
  file.close();
  EXPECT_EQ(test::read_file(folder.path() / "x"), "abZ");
}

TEST(InputHash, IsSha256) {
  // FIPS 180-4, example of one block.
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(InputHash, ChangesWithConfigAndCommandLine) {
  SystemDescription system;
  system.source = "{}";
  const auto plain = hash_inputs(system, {}).all;
  EXPECT_EQ(plain, hash_inputs(system, {}).all);
  EXPECT_NE(plain, hash_inputs(system, std::vector<std::string>{"--set a.b=1"}).all);
  system.source = "{ }";
  EXPECT_NE(plain, hash_inputs(system, {}).all);
}

TEST(InputHash, IncludesAllFilesOfANetwork) {
  const test::Folder folder;
  const auto write = [&](std::string_view name, std::string_view text) { test::write_file(folder / name, text); };
  std::filesystem::create_directories(folder / "vectors");
  write("network.json", "{}");
  write("vectors/000.picture", "1");
  SystemDescription system;
  auto& instance = system.instances.emplace_back();
  instance.name = "soc";
  instance.fmu_path = folder / "network.json";  // any existing file
  instance.parameters.push_back({"network", folder.path().string(), ""});
  const auto plain = hash_inputs(system, {});
  EXPECT_EQ(plain.files[1].first, "soc.network vectors/000.picture");
  write("vectors/000.picture", "2");
  EXPECT_NE(plain.all, hash_inputs(system, {}).all);
  write("vectors/000.picture", "1");
  EXPECT_EQ(plain.all, hash_inputs(system, {}).all);
  write("notes", "");
  EXPECT_NE(plain.all, hash_inputs(system, {}).all);
  instance.parameters[0].variable = "firmware";
  EXPECT_TRUE(hash_inputs(system, {}).files.empty()) << "such a text may name something inside the FMU";
}

TEST(Summary, ALabelOfItsOwnIsRefused) {
  TestRun run(
      R"({"step": 0.1, "stop_time": 0.1, "instances": {"a": {"fmu": "PROBE"}}, "connections": [], "summary": {"outcome": "a.steps"}})");
  EXPECT_THAT(test::input_error([&] { SummaryValues values(run.system, run.simulation().ensemble()); }),
              HasSubstr("'outcome' is used"));
}

TEST(Summary, ValuesKeepTheirKind) {
  TestRun run(
      R"({"step": 0.1, "stop_time": 0.3, "instances": {"a": {"fmu": "PROBE", "parameters": {"mode_in": "both", "real_in": 1.5}}}, "connections": [],
                  "summary": {"x": "a.real_out", "inner": {"mode": "a.mode_out", "flag": "a.boolean_out"}, "n": "a.steps", "text": "a.string_out"}})");
  SummaryValues values(run.system, run.simulation().ensemble());
  run.simulation().add(values);
  EXPECT_EQ(values.values().dump(), "{}");
  run.to_end();
  EXPECT_EQ(values.values().dump(), R"({"x":1.5,"inner":{"mode":"both","flag":true},"n":3,"text":"!"})");
  EXPECT_EQ(values.units().dump(), R"({"x":"metre"})");
}

TEST(Summary, StatisticsHaveAllValuesOfUInt64) {
  TestRun run(fmt::format(R"({{"step": 0.1, "stop_time": 0.1, "instances": {{
      "a": {{"fmu": "{0}", "parameters": {{"huge": 9223372036854775808}}}}, "b": {{"fmu": "{0}", "parameters": {{"huge": 2}}}}}},
    "summary": {{"n": [{{"name": "a", "variable": "a.huge_out"}}, {{"name": "b", "variable": "b.huge_out"}}]}}}})",
                          WIDTHS_FMU));
  SummaryValues values(run.system, run.simulation().ensemble());
  run.simulation().add(values);
  run.to_end();
  const auto all = values.values().at("n");
  EXPECT_EQ(all.at("least"), 2);
  EXPECT_EQ(all.at("mean"), 0x1p62);
  EXPECT_EQ(all.at("most"), 9223372036854775808U);
  EXPECT_EQ(all.at("most_of"), "a");
}

}  // namespace
}  // namespace mebots::master
