// SPDX-License-Identifier: Apache-2.0
// Tests arguments, exit codes, streams and files of the program.
#include "base/sha256.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include "mebots/modeldesc/archive.hpp"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>

namespace mebots::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class Program : public testing::Test {
 protected:
  Program() { write_file(folder.path() / "two.json", with_probe(kConfig)); }

  ProgramResult run(std::vector<std::string> arguments) const { return run_program(arguments, folder.path()); }
  ProgramResult run_config(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"run", "two.json"});
    return run(more);
  }
  std::filesystem::path results() const { return folder.path() / "results" / "two"; }
  nlohmann::json summary() const { return nlohmann::json::parse(read_file(results() / "summary.json")); }

  static constexpr const char* kConfig = R"({"step": 0.1, "stop_time": 1, "instances": {
      "a": {"fmu": "PROBE", "parameters": {"gain": 2, "real_in": 3}}, "b": {"fmu": "PROBE"}},
    "connections": [{"from": "a.real_out", "to": "b.real_in"}],
    "summary": {"length": "b.integral", "energy": {"motors": "a.real_out"}}})";

  modeldesc::TemporaryFolder folder{"mebots-test"};
};

TEST_F(Program, ARunLeavesResultsAndSummary) {
  const auto result = run_config();
  EXPECT_EQ(result.code, 0);
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("notice: a: not connected"), HasSubstr("[    0.000 s] a: hello from the first step"),
                    HasSubstr("outcome: completed"), HasSubstr("results/two/results.csv")));
  const auto json = summary();
  EXPECT_EQ(json["outcome"], "completed");
  EXPECT_EQ(json["end_reason"], "stop_time");
  EXPECT_EQ(json["simulated_time"], 1.0);
  EXPECT_EQ(json["steps"], 10);
  EXPECT_EQ(json["rows"], 11);
  EXPECT_GT(json["real_time_factor"], 0.0);
  EXPECT_EQ(json["energy"]["motors"], 6.0);
  EXPECT_EQ(json["units"]["length"], "m.s");
  EXPECT_EQ(json["versions"]["instances"]["a"]["generation_tool"], "by hand");
  EXPECT_EQ(json["inputs"]["sha256"].get<std::string>().size(), 64u);
  EXPECT_THAT(read_file(results() / "log.txt"), HasSubstr("b: hello from the first step"));
}

TEST_F(Program, SummaryIsTheSameButForWallClockAndRealTimeFactor) {
  const auto once = [&] {
    run_config();
    auto json = summary();
    json.erase("wall_clock");
    json.erase("real_time_factor");
    return json;
  };
  EXPECT_EQ(once(), once());
}

TEST_F(Program, AValueThatWasNotMeasuredIsLeftOutOfTheSummary) {
  const auto summary_when = [&](const std::string& limit) {
    write_file(folder.path() / "measured.json",
               with_probe(R"({"step": 0.1, "stop_time": 1, "instances": {"a": {"fmu": "PROBE"}}, "connections": [],
                 "summary": {"length": {"variable": "a.last_end", "when": [{"variable": "a.steps", "above": )" +
                          limit + "}]}}}"));
    EXPECT_EQ(run({"run", "measured.json", "--quiet"}).code, 0);
    return nlohmann::json::parse(read_file(folder.path() / "results/measured/summary.json"));
  };
  EXPECT_EQ(summary_when("9")["length"], 1.0);
  EXPECT_EQ(summary_when("9")["units"]["length"], "s");
  EXPECT_FALSE(summary_when("10").contains("length"));
  EXPECT_FALSE(summary_when("10")["units"].contains("length"));
}

TEST_F(Program, TheSummaryListsTheStartValuesOfTheRun) {
  run_config({"--set", "b.mode_in=both"});
  EXPECT_EQ(summary()["parameters"]["a"]["gain"], 2.0);
  EXPECT_EQ(summary()["parameters"]["b"]["mode_in"], 7);
}

TEST_F(Program, AnOutcomeOtherThanExpectedIsAnsweredByOne) {
  EXPECT_EQ(run_config({"--expect", "completed", "--junit", "pass.xml"}).code, 0);
  EXPECT_THAT(read_file(folder.path() / "pass.xml"), AllOf(HasSubstr("failures=\"0\""), HasSubstr("name=\"two\"")));
  const auto other = run_config({"--expect", "interrupted", "--expect", "failed", "--junit", "fail.xml"});
  EXPECT_EQ(other.code, 1);
  EXPECT_THAT(other.err, AllOf(HasSubstr("'completed'"), HasSubstr("interrupted or failed")));
  EXPECT_THAT(read_file(folder.path() / "fail.xml"), HasSubstr("failures=\"1\""));
  EXPECT_EQ(run_config({"--set", "a.fault=error", "--junit", "error.xml"}).code, 1);
  EXPECT_THAT(read_file(folder.path() / "error.xml"), AllOf(HasSubstr("errors=\"1\""), HasSubstr("fmi2Error")));
}

TEST_F(Program, AConfigIsNotReplacedByTheResultsOfItsRun) {
  std::filesystem::create_directory(folder.path() / "out");
  const auto config = read_file(folder.path() / "two.json");
  write_file(folder.path() / "out/summary.json", config);
  const auto result = run({"run", "out/summary.json", "--out", "out"});
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err, AllOf(HasSubstr("out/summary.json"), HasSubstr("Choose another folder with --out")));
  EXPECT_EQ(read_file(folder.path() / "out/summary.json"), config);
}

TEST_F(Program, OptionsChangeTheRun) {
  const auto result =
      run_config({"--set", "a.gain=3", "--set", "a.offset=1", "--stop-time", "0.5", "--out", "elsewhere/deep"});
  EXPECT_EQ(result.code, 0);
  const auto json = nlohmann::json::parse(read_file(folder.path() / "elsewhere/deep/summary.json"));
  EXPECT_EQ(json["energy"]["motors"], 10.0);
  EXPECT_EQ(json["simulated_time"], 0.5);
  EXPECT_EQ(json["inputs"]["changes"], nlohmann::json({"set a.gain=3", "set a.offset=1", "stop_time 0.5"}));
}

TEST_F(Program, SetTakesSeveralAssignments) {
  const auto result = run_config({"--set", "a.gain=3", "a.offset=1", "b.string_in=x=y", "--stop-time", "0.5"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(summary()["inputs"]["changes"],
            nlohmann::json({"set a.gain=3", "set a.offset=1", "set b.string_in=x=y", "stop_time 0.5"}));
}

TEST_F(Program, SetFindsNamesWithAnEqualsSign) {
  const test::ChangedFmu fmu("probe", "name=\"offset\"", "name=\"gain=2\"");
  write_file(
      folder.path() / "one.json",
      fmt::format(R"({{"step": 0.1, "stop_time": 0.2, "instances": {{"a": {{"fmu": "{}"}}}}, "connections": []}})",
                  fmu.path().string()));
  const auto result = run({"run", "one.json", "--out", "results/two", "--set", "a.gain=2=5", "a.gain=3"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(summary()["parameters"]["a"], nlohmann::json({{"gain", 3.0}, {"gain=2", 5.0}}));
}

TEST_F(Program, SetSetsAllVariablesThatFitAPattern) {
  write_file(folder.path() / "group.json", with_probe(R"({"step": 0.1, "stop_time": 0.2, "connections": [], "instances":
      {"drone[{i}]": {"repeat": {"i": [1, 3]}, "fmu": "PROBE"}, "pad": {"fmu": "PROBE"}}})"));
  const auto result = run({"run", "group.json", "--out", "results/two", "--set", "drone[*].gain=3", "drone[2].gain=4",
                           "drone[?].string_in=x=y"});
  ASSERT_EQ(result.code, 0) << result.err;
  const auto parameters = summary()["parameters"];
  EXPECT_EQ(parameters["drone[1]"]["gain"], 3.0);
  EXPECT_EQ(parameters["drone[2]"]["gain"], 4.0);
  EXPECT_EQ(parameters["drone[3]"]["string_in"], "x=y");
  EXPECT_FALSE(parameters.contains("pad"));
  EXPECT_EQ(summary()["inputs"]["changes"][0], "set drone[1].gain=3");
  const auto missing = run({"run", "group.json", "--dry-run", "--set", "drone[*].gian=3"});
  EXPECT_EQ(missing.code, 2);
  EXPECT_THAT(missing.err, HasSubstr("--set drone[*].gian=3: no variable fits 'drone[*].gian'. Did you mean "
                                     "'drone[*].gain'"));
  const auto output = run({"run", "group.json", "--dry-run", "--set", "drone[*].real_out=3"});
  EXPECT_EQ(output.code, 2);
  EXPECT_THAT(output.err, HasSubstr("'drone[1].real_out' cannot be set"));
}

TEST_F(Program, APatternForAnFmuAloneNeedsNoInstance) {
  const auto result = run({"run", PROBE_FMU, "--out", "results/two", "--set", "ga*n=3"});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(summary()["inputs"]["changes"][0], "set probe.gain=3");
}

TEST_F(Program, ADryRunChecksEverythingAndWritesNothing) {
  const auto fine = run_config({"--dry-run"});
  EXPECT_EQ(fine.code, 0) << fine.err;
  EXPECT_THAT(fine.out, AllOf(HasSubstr("two: 2 instances (a, b), 1 connections"),
                              HasSubstr("to 1 s in 10 steps of 0.1 s"), HasSubstr("nothing was written")));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "results"));
  EXPECT_EQ(run_config({"--dry-run", "--set", "a.gian=2"}).code, 2);
}

TEST_F(Program, ASummaryHasTenLinesAndTheRestWithVerbose) {
  std::string labels;
  for (int group = 0; group < 20; ++group)
    labels += fmt::format(R"("g{0}": {{"x": "a.real_out", "y": "b.integral"}},)", group);
  write_file(folder.path() / "many.json",
             with_probe(fmt::format(
                 R"({{"step": 0.1, "stop_time": 1, "instances": {{"a": {{"fmu": "PROBE"}}, "b": {{"fmu": "PROBE"}}}},
          "connections": [], "summary": {{{} "last": "b.integral"}}}})",
                 labels)));
  const auto lines_after_outcome = [](const std::string& text) {
    const auto end = text.substr(text.find("outcome: "));
    return std::count(end.begin(), end.end(), '\n');
  };
  const auto brief = run({"run", "many.json"});
  EXPECT_EQ(lines_after_outcome(brief.out), 10) << brief.out;
  EXPECT_THAT(brief.out, AllOf(HasSubstr("  last 0"), HasSubstr("  g0: x 0"), HasSubstr("(all values: --verbose)")));
  const auto verbose = run({"run", "many.json", "--verbose"});
  EXPECT_EQ(lines_after_outcome(verbose.out), 3 + 41) << verbose.out;
}

TEST_F(Program, QuietShowsNothingButErrors) {
  const auto fine = run_config({"--quiet"});
  EXPECT_EQ(fine.code, 0);
  EXPECT_THAT(fine.out + fine.err, IsEmpty());
  const auto failing = run_config({"--quiet", "--set", "a.fault=error"});
  EXPECT_EQ(failing.code, 1);
  EXPECT_THAT(failing.out, IsEmpty());
  EXPECT_THAT(failing.err, HasSubstr("fmi2Error"));
}

TEST_F(Program, AFailingRunKeepsItsRowsAndSaysWhy) {
  const auto result = run_config({"--set", "b.fault=nan", "--set", "b.fault_time=0.4"});
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.err, AllOf(HasSubstr("instance 'b' at 0.4 s"), HasSubstr("'real_out' is nan")));
  EXPECT_THAT(read_file(results() / "results.csv"), AllOf(HasSubstr("\n0.3"), Not(HasSubstr("\n0.4"))));
  EXPECT_EQ(summary()["outcome"], "failed");
  EXPECT_THAT(summary()["error"].get<std::string>(), HasSubstr("'real_out' is nan"));
  EXPECT_EQ(summary()["simulated_time"], 0.3);
}

TEST_F(Program, ASecondRunIntoTheSameFolderIsRefusedByTheFirstOnesNumber) {
  const auto child = fork();
  if (child == 0) {
    if (chdir(folder.path().c_str()) != 0) _exit(99);
    execl(MEBOTS_PROGRAM, MEBOTS_PROGRAM, "run", "two.json", "--quiet", "--set", "a.fault=slow", "--set",
          "a.fault_time=0", "--stop-time", "100", nullptr);
    _exit(98);
  }
  while (!std::filesystem::exists(results() / "results.csv"))
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const auto second = run_config();
  EXPECT_EQ(second.code, 2);
  EXPECT_THAT(second.err, HasSubstr(fmt::format("(process {})", child)));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_EQ(run_config().code, 0) << "a run that was killed keeps the folder from nobody";
  EXPECT_FALSE(std::filesystem::exists(results() / ".mebots.lock"));
}

TEST_F(Program, AnInterruptIsAnsweredBetweenTwoCallsToFmus) {
  // A communication step takes 1.2 s: 60 instances, each of which takes 20 ms.
  std::string instances;
  for (int i = 0; i < 60; ++i) {
    instances += fmt::format(R"({}"i{}": {{"fmu": "PROBE", "parameters": {{"fault": "slow", "fault_time": 0}}}})",
                             i == 0 ? "" : ", ", i);
  }
  write_file(folder.path() / "slow.json",
             with_probe(fmt::format(R"({{"step": 0.1, "stop_time": 10, "instances": {{{}}}, "connections": []}})",
                                    instances)));
  const auto child = fork();
  if (child == 0) {
    if (chdir(folder.path().c_str()) != 0) _exit(99);
    execl(MEBOTS_PROGRAM, MEBOTS_PROGRAM, "run", "slow.json", "--quiet", nullptr);
    _exit(98);
  }
  while (!std::filesystem::exists(folder.path() / "results/slow/results.csv")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const auto asked = std::chrono::steady_clock::now();
  kill(child, SIGTERM);
  int status = 0;
  waitpid(child, &status, 0);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - asked;
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_EQ(nlohmann::json::parse(read_file(folder.path() / "results/slow/summary.json"))["outcome"], "interrupted");
  EXPECT_LT(took.count(), 1.0) << "it waited for the whole communication step";
  RecordProperty("seconds", std::to_string(took.count()));
}

TEST_F(Program, BadUsageIsAnsweredByTwo) {
  for (const auto& arguments :
       {std::vector<std::string>{}, {"fly"}, {"run"}, {"run", "two.json", "--fast"}, {"info"}}) {
    const auto result = run(arguments);
    EXPECT_EQ(result.code, 2) << testing::PrintToString(arguments);
    EXPECT_THAT(result.err, Not(IsEmpty()));
  }
  for (const auto& more : {std::vector<std::string>{"--stop-time", "nan"},
                           {"--step", "0"},
                           {"--checkpoint-every", "1e400"},
                           {"--set", "gain=3"}}) {
    const auto result = run_config(more);
    EXPECT_EQ(result.code, 2) << testing::PrintToString(more);
    EXPECT_THAT(result.err, HasSubstr(more.front() + " " + more.back()));
  }
  EXPECT_EQ(run_config({"--step", "0", "--junit", "junit.xml"}).code, 2);
  EXPECT_THAT(read_file(folder.path() / "junit.xml"), HasSubstr("errors=\"1\""));
  EXPECT_EQ(run({"--help"}).code, 0);
  EXPECT_EQ(run({"--version"}).code, 0);
}

TEST_F(Program, MistakesOnTheCommandLineAreNamedWithTheWayOut) {
  const auto expect = [&](const std::vector<std::string>& arguments, const char* text) {
    const auto result = run(arguments);
    EXPECT_EQ(result.code, 2) << testing::PrintToString(arguments);
    EXPECT_THAT(result.err, HasSubstr(text)) << testing::PrintToString(arguments);
  };
  expect({"rnu", "two.json"}, "there is no command 'rnu'. Did you mean 'run'?");
  std::filesystem::copy(PROBE_FMU, folder.path() / "probe.zip");
  expect({"run", "probe.zip"}, "the name of an FMU must end in .fmu");
  expect({"run", "/dev/zero"}, "/dev/zero: cannot be read: it is a device");
  expect({"run", "two.json", "--scenario", "/dev/zero"}, "it is a device");
  expect({"run", "two.json", "--out", ""}, "--out: the name is empty");
  expect({"run", "two.json", "--expect", "complted"}, "cannot have the outcome 'complted'. Did you mean 'completed'?");
  expect({"run", "two.json", "--junit", "nowhere/two.xml"}, "there is no folder nowhere; create it first");
  expect({"check", PROBE_FMU, "--deadline", "nan"}, "--deadline: nan is not a number greater than 0");
  expect({"convert", "two.json", "two.json"}, "both files are .json");
  expect({"convert", "two.json", "nowhere/two.ssp"}, "there is no folder nowhere");
  write_file(folder.path() / "deep.json", std::string(1'000'000, '['));
  expect({"new-fmu", "deep.json"}, "this is nested more than 100 levels deep");
  expect({"new-fmu", "."}, "it is a folder");
  const std::string long_name(300, 'x');  // too long for a file name; std::filesystem throws
  expect({"check", long_name + ".fmu"}, "there is no such file");
  expect({"info", long_name + ".fmu"}, "there is no such file");
  expect({"report", long_name}, "there is no such folder");
  expect({"run", long_name + ".ssp"}, "File name too long");
  std::filesystem::create_directories(folder.path() / "strange");
  std::filesystem::create_symlink("/dev/zero", folder.path() / "strange/checkpoint.bin");
  expect({"resume", "strange"}, "checkpoint.bin: cannot be read: it is a device");
}

TEST_F(Program, ClosedStreamsGetIntoNoFile) {
  ASSERT_EQ(run({"run", "two.json"}).code, 0);
  const auto csv = read_file(results() / "results.csv");
  const auto command = fmt::format("cd '{}' && '{}' run two.json <&- >&- 2>&-", folder.path().string(), MEBOTS_PROGRAM);
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(read_file(results() / "results.csv"), csv);
}

TEST_F(Program, ACommandWhoseOutputHasNoRoomFails) {
  for (const char* arguments : {"info two.json", "schema rotor", "units", "check --json --files-only " PROBE_FMU}) {
    const auto command =
        fmt::format("cd '{}' && '{}' {} >/dev/full", folder.path().string(), MEBOTS_PROGRAM, arguments);
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1) << arguments;
  }
}

TEST_F(Program, QuotesSuggestedCommandsForTheShell) {
  write_file(folder.path() / "d.json", R"({"name": "d", "text": "A length", "step": 1, "stop_time": 1, "variables": [
      {"name": "out", "causality": "output", "unit": "m", "text": "A length"}]})");
  EXPECT_THAT(run({"new-fmu", "d.json", "--out", "my fmu"}).out, HasSubstr("cmake -S 'my fmu' -B 'my fmu'/build "));
  for (const char* command : {"new-firmware", "new-sensor"}) {
    const auto out = std::string("it's ") + command;
    EXPECT_THAT(run({command, "blink", "--out", out}).out, HasSubstr(fmt::format("  cd 'it'\\''s {}'\n", command)));
  }
}

TEST_F(Program, ALogCategoryThatTheFmuDoesNotDeclareIsNoticed) {
  write_file(folder.path() / "log.json", with_probe(R"({"step": 0.1, "stop_time": 1, "connections": [],
      "instances": {"a": {"fmu": "PROBE"}}, "log": {"a": ["consol", "*"]}})"));
  EXPECT_THAT(run({"run", "log.json"}).out,
              HasSubstr("a: its FMU declares no log category 'consol'. Did you mean 'console'?"));
}

TEST_F(Program, BadInputIsAnsweredByTwoAndLeavesNoFolder) {
  write_file(folder.path() / "typo.json", R"({"stpe": 0.1})");
  EXPECT_EQ(run({"run", "typo.json"}).code, 2);
  EXPECT_EQ(run({"run", "missing.json"}).code, 2);
  EXPECT_EQ(run_config({"--set", "a.gian=3"}).code, 2);
  EXPECT_EQ(run_config({"--stop-time", "0.55"}).code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "results"));
}

TEST_F(Program, AnFmuThatRefusesItsParametersIsBadInput) {
  const auto result = run_config({"--set", "a.fault=initialisation"});
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err, HasSubstr("does not like its parameters"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "results"));
}

TEST_F(Program, ARefusedRunLeavesEarlierResultsAsTheyWere) {
  ASSERT_EQ(run_config().code, 0);
  const auto files = {"results.csv", "summary.json", "log.txt", "system.json"};
  std::vector<std::string> before;
  for (const auto* file : files) before.push_back(read_file(results() / file));
  EXPECT_EQ(run_config({"--set", "a.fault=initialisation"}).code, 2);
  EXPECT_EQ(run_config({"--set", "a.gian=3"}).code, 2);
  std::vector<std::string> after;
  for (const auto* file : files) after.push_back(read_file(results() / file));
  EXPECT_EQ(before, after);
  const std::filesystem::directory_iterator left(results());
  EXPECT_EQ(std::distance(begin(left), end(left)), 4);
}

TEST_F(Program, AFolderThatCannotBeMadeIsBadInput) {
  write_file(folder.path() / "file", "");
  for (const char* out : {"file", "file/deeper", "/proc/nothing"}) {
    const auto result = run_config({"--out", out});
    EXPECT_EQ(result.code, 2) << out;
    EXPECT_THAT(result.err, HasSubstr("the results folder cannot be created")) << out;
  }
}

TEST_F(Program, LinksInThePlaceOfFilesOfTheRunAreNotFollowed) {
  std::filesystem::create_directories(results());
  write_file(folder.path() / "thesis.txt", "mine");
  for (const char* name : {"results.csv", "results.h5", "log.txt", "system.json", "parameters.csv", "summary.json"})
    std::filesystem::create_symlink(folder.path() / "thesis.txt", results() / (std::string(name) + ".new"));
  ASSERT_EQ(run_config().code, 0);
  EXPECT_EQ(read_file(folder.path() / "thesis.txt"), "mine");
  EXPECT_FALSE(std::filesystem::is_symlink(results() / "summary.json"));
}

TEST_F(Program, AFileAtTheLimitOfItsSizeIsReportedAndTheSummaryStillWritten) {
  const auto command = fmt::format("ulimit -f 4000; cd '{}' && '{}' run two.json --quiet --stop-time 10000 2>err",
                                   folder.path().string(), MEBOTS_PROGRAM);
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
  EXPECT_THAT(read_file(folder.path() / "err"), AllOf(HasSubstr("results.csv"), HasSubstr("File too large")));
  EXPECT_EQ(summary()["outcome"], "failed");
}

TEST_F(Program, AnInterruptEndsCleanlyWithItsResults) {
  const auto child = fork();
  if (child == 0) {
    if (chdir(folder.path().c_str()) != 0) _exit(99);
    // Each step takes 20 ms. Without an interrupt, the run takes 20 s.
    execl(MEBOTS_PROGRAM, MEBOTS_PROGRAM, "run", "two.json", "--quiet", "--stop-time", "100", "--set", "a.fault=slow",
          "--set", "a.fault_time=0", nullptr);
    _exit(98);
  }
  while (!std::filesystem::exists(results() / "log.txt")) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  const auto json = summary();
  EXPECT_EQ(json["outcome"], "interrupted");
  EXPECT_EQ(json["end_reason"], "interrupted");
  const auto csv = read_file(results() / "results.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), json["rows"].get<int>() + 1);
  EXPECT_GT(json["rows"], 1);
}

TEST_F(Program, ACheckThatIsInterruptedLeavesNoFiles) {
  const auto temporary = folder.path() / "temporary";
  std::filesystem::create_directory(temporary);
  const auto child = fork();
  if (child == 0) {
    setenv("TMPDIR", temporary.c_str(), 1);
    execl(MEBOTS_PROGRAM, MEBOTS_PROGRAM, "check", PROBE_FMU, nullptr);
    _exit(98);
  }
  while (std::filesystem::is_empty(temporary)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGINT) << status;
  EXPECT_TRUE(std::filesystem::is_empty(temporary));
}

TEST_F(Program, InfoShowsWhatAnFmuSaysOfItself) {
  const auto result = run({"info", PROBE_FMU});
  EXPECT_EQ(result.code, 0);
  EXPECT_THAT(result.out, AllOf(HasSubstr("probe"), HasSubstr("{probe}"), HasSubstr("A foreign FMU for tests"),
                                HasSubstr("by hand"), HasSubstr("saves state"),
                                HasSubstr("Mode: off = 0, on = 1, both = 7"), HasSubstr("-10 .. 10")));
  EXPECT_THAT(result.out, testing::ContainsRegex("real_in +input +continuous +Real +m +0"));
}

TEST_F(Program, InfoShowsTerminals) {
  const auto unpacked = folder.path() / "unpacked";
  modeldesc::unpack(PROBE_FMU, unpacked);
  std::filesystem::create_directory(unpacked / "terminalsAndIcons");
  write_file(unpacked / "terminalsAndIcons/terminalsAndIcons.xml", R"(<fmiTerminalsAndIcons fmiVersion="3.0"><Terminals>
    <Terminal name="plug" matchingRule="bus" terminalKind="org.example.plug" description="A plug">
      <TerminalMemberVariable variableName="real_in" memberName="in" variableKind="signal"/>
      <Terminal name="pin" matchingRule="plug">
        <TerminalMemberVariable variableName="real_out" memberName="out" variableKind="signal"/>
      </Terminal></Terminal></Terminals></fmiTerminalsAndIcons>)");
  std::vector<modeldesc::PackedFile> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(unpacked)) {
    if (entry.is_regular_file()) files.push_back({entry.path().lexically_relative(unpacked).string(), entry.path()});
  }
  modeldesc::pack(folder.path() / "with.fmu", files);
  const auto result = run({"info", "with.fmu"});
  EXPECT_EQ(result.code, 0);
  EXPECT_THAT(result.out, testing::ContainsRegex("plug +org.example.plug +bus +in +real_in +A plug"));
  EXPECT_THAT(result.out, testing::ContainsRegex("plug.pin +plug +out +real_out"));
  EXPECT_THAT(run({"info", PROBE_FMU}).out, testing::Not(HasSubstr("terminal")));
}

TEST_F(Program, InfoShowsKindsOfClocks) {
  const auto result = run({"info", METRONOME_FMU});
  EXPECT_EQ(result.code, 0);
  EXPECT_THAT(result.out, testing::ContainsRegex("beat +input +periodic +constant +0.3 +0.15 +beats"));
  EXPECT_THAT(result.out, testing::ContainsRegex("echo +input +countdown +0"));
  EXPECT_THAT(result.out, testing::ContainsRegex("tock +output +triggered +tock_time"));
  EXPECT_THAT(result.out, testing::ContainsRegex("tap +input +triggered +heard"));
  EXPECT_THAT(run({"info", PROBE_FMU}).out, testing::Not(HasSubstr("interval")));
}

TEST_F(Program, InfoOnSomethingElseIsBadInput) {
  EXPECT_EQ(run({"info", "nothing.fmu"}).code, 2);
  write_file(folder.path() / "text.fmu", "no archive");
  const auto result = run({"info", "text.fmu"});
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err, HasSubstr("text.fmu"));
}

TEST_F(Program, InfoOnAConfigShowsTheSystem) {
  const auto result = run({"info", "two.json"});
  EXPECT_EQ(result.code, 0);
  EXPECT_THAT(result.out, testing::ContainsRegex("a.real_out +b.real_in +1 +0"));
}

TEST_F(Program, SchemaPrintsTheSchema) {
  const auto result = run({"schema"});
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(nlohmann::json::parse(result.out)["title"], "MEbots config");
}

}  // namespace
}  // namespace mebots::test
