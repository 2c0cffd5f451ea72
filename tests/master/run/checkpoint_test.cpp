// SPDX-License-Identifier: Apache-2.0
// Tests that a killed run resumes from its last checkpoint with the same bits as an undisturbed run.
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <csignal>
#include <random>
#include <thread>

namespace mebots::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// `a` sleeps in each step. The run takes about half a second, so that it can be killed.
constexpr const char* kSavedSystem = R"({"step": 0.01, "stop_time": 3, "instances": {
    "a": {"fmu": "PROBE", "parameters": {"gain": -0.9, "offset": 0.3, "fault": "nap", "fault_time": 0}},
    "b": {"fmu": "PROBE", "parameters": {"gain": 0.8}, "step": 0.03}},
  "connections": [{"from": "a.real_out", "to": "b.real_in"}, {"from": "b.real_out", "to": "a.real_in"},
                  {"from": "a.buffer", "to": "b.taken"}, {"from": "a.steps", "to": "b.integer_in"}],
  "stop_when": [{"variable": "a.steps", "above": 100, "for": 1.5}],
  "outcomes": [{"outcome": "seen", "when": [{"variable": "a.steps", "equals": 100, "ever": true}]}],
  "summary": {"sum": "b.integral", "taken": "b.taken_sum"}})";

class Checkpoints : public testing::Test {
 protected:
  Checkpoints() { write_file(folder.path() / "two.json", with_probe(kSavedSystem)); }

  pid_t start(const std::vector<std::string>& arguments) const {
    const auto child = fork();
    if (child != 0) return child;
    std::vector<char*> words{const_cast<char*>(MEBOTS_PROGRAM)};
    for (const auto& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    if (chdir(folder.path().c_str()) == 0) execv(MEBOTS_PROGRAM, words.data());
    _exit(98);
  }
  static int wait(pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  std::string result(const std::string& run, const std::string& file) const {
    return read_file(folder.path() / run / file);
  }
  nlohmann::json summary(const std::string& run) const {
    auto json = nlohmann::json::parse(result(run, "summary.json"));
    json.erase("wall_clock");
    json.erase("real_time_factor");
    return json;
  }
  ProgramResult run(const std::vector<std::string>& arguments) const { return run_program(arguments, folder.path()); }

  /// Kills the run, and then each resumed run, after random times, until a run reaches its end. Returns the number of
  /// kills.
  int run_with_kills(const std::vector<std::string>& begin, unsigned seed) const {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> delay_us(1'000, 150'000);
    int kills = 0;
    bool begun = false;
    while (true) {
      const auto child = start(begun ? std::vector<std::string>{"resume", "killed", "--quiet"} : begin);
      std::this_thread::sleep_for(std::chrono::microseconds(delay_us(random)));
      kill(child, SIGKILL);
      const int code = wait(child);
      if (code == 0) return kills;
      EXPECT_EQ(code, 128 + SIGKILL);
      ++kills;
      begun = std::filesystem::exists(folder.path() / "killed" / "checkpoint.bin");
      if (kills > 60) delay_us = std::uniform_int_distribution<int>(1'000'000, 2'000'000);  // for a very slow machine
      if (kills > 100) throw Error("the run never comes to its end");
    }
  }

  modeldesc::TemporaryFolder folder{"mebots-test"};
};

TEST_F(Checkpoints, ARunKilledAtAnyMomentIsResumedToTheSameBits) {
  ASSERT_EQ(run({"run", "two.json", "--out", "straight"}).code, 0);
  int kills = 0;
  for (const unsigned seed : {1u, 2u, 3u}) {
    std::filesystem::remove_all(folder.path() / "killed");
    kills += run_with_kills({"run", "two.json", "--out", "killed", "--quiet", "--checkpoint-every", "0.05"}, seed);
    EXPECT_TRUE(result("killed", "results.csv") == result("straight", "results.csv"));
    EXPECT_EQ(result("killed", "log.txt"), result("straight", "log.txt"));
    EXPECT_EQ(summary("killed"), summary("straight"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "killed" / "checkpoint.bin"));
  }
  EXPECT_GE(kills, 6);
}

TEST_F(Checkpoints, InstancesInOwnProcessesAreResumedToo) {
  ASSERT_EQ(run({"run", "two.json", "--out", "straight"}).code, 0);
  run_with_kills({"run", "two.json", "--out", "killed", "--quiet", "--isolate", "--checkpoint-every", "0.1"}, 4);
  EXPECT_TRUE(result("killed", "results.csv") == result("straight", "results.csv"));
  EXPECT_EQ(summary("killed"), summary("straight"));
}

TEST_F(Checkpoints, ALivePageIsNoPartOfACheckpoint) {
#ifndef MEBOTS_TEST_HAS_PAGES
  GTEST_SKIP() << "built without pages (MEBOTS_PAGES)";
#endif
  auto system = nlohmann::json::parse(with_probe(kSavedSystem));
  system["record"] = {{"format", "both"}};
  write_file(folder.path() / "both.json", system.dump());
  ASSERT_EQ(run({"run", "both.json", "--out", "straight"}).code, 0);
  const std::vector<std::string> live{"--live", "0", "--live-start", "now", "--no-live-keep"};
  for (const bool begins_live : {false, true}) {
    std::filesystem::remove_all(folder.path() / "killed");
    std::vector<std::string> begin{"run", "both.json", "--out", "killed", "--quiet", "--checkpoint-every", "0.5"};
    std::vector<std::string> resume{"resume", "killed"};
    auto& served = begins_live ? begin : resume;
    served.insert(served.end(), live.begin(), live.end());
    const auto child = start(begin);
    while (!std::filesystem::exists(folder.path() / "killed" / "checkpoint.bin")) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    kill(child, SIGKILL);
    wait(child);
    const auto resumed = run(resume);
    EXPECT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_TRUE(result("killed", "results.csv") == result("straight", "results.csv")) << "live first: " << begins_live;
    EXPECT_EQ(result("killed", "log.txt"), result("straight", "log.txt"));
    EXPECT_EQ(summary("killed"), summary("straight"));
  }
}

TEST_F(Checkpoints, ARunUnderStepControlIsResumedToTheSameSteps) {
  auto system = nlohmann::json::parse(with_probe(kSavedSystem));
  system["step_control"] = {{"max_step", 0.04}, {"relative_tolerance", 0.05}, {"rollback", "required"}};
  system["record"] = {{"variables", {"*"}}, {"step", true}};
  system["instances"]["b"].erase("step");
  write_file(folder.path() / "controlled.json", system.dump());
  ASSERT_EQ(run({"run", "controlled.json", "--out", "straight"}).code, 0);
  const int kills =
      run_with_kills({"run", "controlled.json", "--out", "killed", "--quiet", "--checkpoint-every", "0.05"}, 5);
  EXPECT_GE(kills, 1);
  EXPECT_TRUE(result("killed", "results.csv") == result("straight", "results.csv"));
  EXPECT_EQ(summary("killed"), summary("straight"));
  const auto control = summary("straight")["step_control"];
  EXPECT_LT(control["smallest_step"], control["largest_step"]) << "else the test proves nothing";
}

TEST_F(Checkpoints, AFolderOfPicturesThatIsGoneIsMadeAgain) {
  auto system = nlohmann::json::parse(with_probe(kSavedSystem));
  system["pictures"] = {{{"frame", "a.buffer"}, {"id", "a.steps"}, {"width", 1}}};
  write_file(folder.path() / "seen.json", system.dump());
  const auto child = start({"run", "seen.json", "--out", "seen", "--quiet", "--checkpoint-every", "0.5"});
  while (!std::filesystem::exists(folder.path() / "seen" / "checkpoint.bin")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  kill(child, SIGKILL);
  wait(child);
  std::filesystem::remove_all(folder.path() / "seen" / "pictures");
  const auto resumed = run({"resume", "seen"});
  EXPECT_EQ(resumed.code, 0) << resumed.err;
  EXPECT_FALSE(std::filesystem::is_empty(folder.path() / "seen" / "pictures" / "a.buffer"));
}

TEST_F(Checkpoints, TruncatesResultsAfterTheLastCheckpoint) {
  ASSERT_EQ(run({"run", "two.json", "--out", "straight"}).code, 0);
  const auto child = start({"run", "two.json", "--out", "killed", "--quiet", "--checkpoint-every", "0.5"});
  while (!std::filesystem::exists(folder.path() / "killed" / "checkpoint.bin")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  kill(child, SIGKILL);
  wait(child);
  // After the checkpoint, the file has complete and incomplete rows, and there is an unfinished checkpoint.
  write_file(folder.path() / "killed/results.csv", result("killed", "results.csv") + "7,7,7\n0.123,4");
  write_file(folder.path() / "killed/log.txt", result("killed", "log.txt") + "[ half");
  write_file(folder.path() / "killed/checkpoint.bin.new", "half a checkp");
  EXPECT_EQ(run({"resume", "killed"}).code, 0);
  EXPECT_TRUE(result("killed", "results.csv") == result("straight", "results.csv"));
  EXPECT_EQ(result("killed", "log.txt"), result("straight", "log.txt"));
}

TEST_F(Checkpoints, RowsThatWereChangedSinceTheCheckpointAreNotContinued) {
  const auto child = start({"run", "two.json", "--out", "killed", "--quiet", "--checkpoint-every", "0.5"});
  while (!std::filesystem::exists(folder.path() / "killed" / "checkpoint.bin")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  kill(child, SIGKILL);
  wait(child);
  const auto rows = result("killed", "results.csv");
  auto changed = rows;
  changed[changed.find('\n') + 1] = '9';  // changes the time of the first row
  write_file(folder.path() / "killed/results.csv", changed);
  const auto refused = run({"resume", "killed"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("results.csv"), HasSubstr("are not those that the run wrote")));
  EXPECT_EQ(result("killed", "results.csv"), changed) << "a refused run touches nothing";
  write_file(folder.path() / "killed/results.csv", rows);
  EXPECT_EQ(run({"resume", "killed"}).code, 0);
}

TEST_F(Checkpoints, AnInterruptedRunCanBeResumed) {
  ASSERT_EQ(run({"run", "two.json", "--out", "straight"}).code, 0);
  const auto child = start({"run", "two.json", "--out", "killed", "--quiet", "--checkpoint-every", "0.1"});
  while (!std::filesystem::exists(folder.path() / "killed" / "checkpoint.bin")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  kill(child, SIGINT);
  if (wait(child) == 0) GTEST_SKIP() << "the run was faster than the interrupt";
  EXPECT_EQ(run({"resume", "killed"}).code, 0);
  EXPECT_TRUE(result("killed", "results.csv") == result("straight", "results.csv"));
}

TEST_F(Checkpoints, ChangedInputsAreRefusedByName) {
  write_file(folder.path() / "program.elf", "one");
  const std::vector<std::string> begin = {
      "run", "two.json", "--out", "killed", "--quiet", "--checkpoint-every", "0.1", "--set", "b.string_in=program.elf"};
  const auto child = start(begin);
  while (!std::filesystem::exists(folder.path() / "killed" / "checkpoint.bin")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  kill(child, SIGKILL);
  wait(child);
  write_file(folder.path() / "program.elf", "two");
  auto refused = run({"resume", "killed"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("the inputs have changed since the checkpoint was written"),
                                 HasSubstr("file b.string_in")));
  write_file(folder.path() / "program.elf", "one");
  write_file(folder.path() / "two.json", with_probe(kSavedSystem) + "\n");
  refused = run({"resume", "killed"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("config"));
  write_file(folder.path() / "two.json", with_probe(kSavedSystem));
  EXPECT_EQ(run({"resume", "killed"}).code, 0);
}

TEST_F(Checkpoints, NoCheckpointAndADamagedOneAreBadInput) {
  auto refused = run({"resume", "."});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("there is no checkpoint"));
  const auto child = start({"run", "two.json", "--out", "killed", "--quiet", "--checkpoint-every", "0.1"});
  while (!std::filesystem::exists(folder.path() / "killed" / "checkpoint.bin")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  kill(child, SIGKILL);
  wait(child);
  auto bytes = result("killed", "checkpoint.bin");
  bytes[bytes.size() / 2] ^= 1;
  write_file(folder.path() / "killed/checkpoint.bin", bytes);
  refused = run({"resume", "killed"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, HasSubstr("damaged"));
}

TEST_F(Checkpoints, FmusThatCannotSerialiseAreNamedAtTheStart) {
  auto description = read_file(PROBE_DESCRIPTION);
  const std::string ability = R"( canSerializeFMUstate="true")";
  description.erase(description.find(ability), ability.size());
  write_file(folder.path() / "plain.xml", description);
  modeldesc::pack(folder.path() / "plain.fmu", {{"modelDescription.xml", folder.path() / "plain.xml"},
                                                {"binaries/linux64/probe.so", PROBE_LIBRARY}});
  write_file(folder.path() / "plain.json", R"({"step": 0.1, "stop_time": 1, "connections": [],
      "instances": {"odd one": {"fmu": "plain.fmu"}}})");
  const auto refused = run({"run", "plain.json", "--checkpoint-every", "0.1"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("'odd one' (probe)"), HasSubstr("canSerializeFMUstate")));
}

}  // namespace
}  // namespace mebots::test
