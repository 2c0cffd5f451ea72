// SPDX-License-Identifier: Apache-2.0
// Tests process-wide changes of an FMU in the master's process. They must be reported with the FMU's name, and reverted
// if possible.
#include "fmi/call/foreign_call.hpp"
#include "fmi/process/process_state.hpp"
#include "support/sanitizer.hpp"
#include "test_system.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <sstream>
#include <thread>

namespace mebots::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Containment : public testing::Test {
 protected:
  Containment() {
    write_file(folder.path() / "two.json", with_probe(R"({"step": 0.1, "stop_time": 1, "instances": {
      "a": {"fmu": "PROBE", "parameters": {"real_in": 0.1}}, "b": {"fmu": "PROBE"}}, "connections": [],
      "record": ["*.integral"]})"));
  }
  ProgramResult run(const std::string& fault, const std::string& more = "") const {
    std::vector<std::string> arguments{"run", "two.json", "--set", "b.fault=" + fault, "--set", "b.fault_time=0.5"};
    if (!more.empty()) arguments.push_back(more);
    return run_program(arguments, folder.path());
  }
  std::string result(const std::string& file) const { return read_file(folder.path() / "results" / "two" / file); }

  modeldesc::TemporaryFolder folder{"mebots-test"};
};

TEST_F(Containment, ExitInsideAnFmuEndsTheRunAsAFailureWithItsResults) {
  const auto ended = run("exit");
  EXPECT_EQ(ended.code, 1);
  EXPECT_THAT(ended.err,
              AllOf(HasSubstr("instance 'b' at 0.4 s"), HasSubstr("exit() in fmi2DoStep"), HasSubstr("--isolate")));
  const auto summary = nlohmann::json::parse(result("summary.json"));
  EXPECT_EQ(summary["outcome"], "failed");
  EXPECT_THAT(summary["error"].get<std::string>(), HasSubstr("instance 'b'"));
  EXPECT_THAT(result("results.csv"), AllOf(HasSubstr("\n0.4,"), Not(HasSubstr("\n0.5,"))));
}

TEST_F(Containment, WhateverFunctionOfTheCLibraryEndsTheProcessTheRunFailsWithItsResults) {
  for (const std::string function : {"exit", "quick_exit", "_exit", "_Exit"}) {
    const auto ended = run(function);
    EXPECT_EQ(ended.code, 1) << function;
    EXPECT_THAT(ended.err, AllOf(HasSubstr("instance 'b' at 0.4 s"), HasSubstr(" called " + function + "() in")));
    EXPECT_EQ(nlohmann::json::parse(result("summary.json"))["outcome"], "failed") << function;
    EXPECT_THAT(result("results.csv"), AllOf(HasSubstr("\n0.4,"), Not(HasSubstr("\n0.5,")))) << function;
  }
}

TEST_F(Containment, AnEndByAHandlerOfASignalOrByManyThreadsAtOnceFailsTheRunWithItsResults) {
  for (const std::string fault : {"handler__exit", "threads__exit"}) {
    const auto ended = run(fault);
    EXPECT_EQ(ended.code, 1) << fault;
    EXPECT_THAT(ended.err, HasSubstr(" called _exit() in")) << fault;
    EXPECT_EQ(nlohmann::json::parse(result("summary.json"))["outcome"], "failed") << fault;
    EXPECT_THAT(result("results.csv"), AllOf(HasSubstr("\n0.4,"), Not(HasSubstr("\n0.5,")))) << fault;
  }
}

TEST_F(Containment, TheEndOfAProcessThatAnFmuForksIsNotTheRuns) {
  for (const std::string fault : {"child_exit", "child__exit"}) {
    const auto ended = run(fault);
    EXPECT_EQ(ended.code, 0) << fault << ": " << ended.err;
    EXPECT_THAT(ended.err, Not(HasSubstr("error"))) << fault;
    EXPECT_EQ(nlohmann::json::parse(result("summary.json"))["outcome"], "completed") << fault;
    EXPECT_THAT(result("results.csv"), HasSubstr("\n1,")) << fault;
  }
}

TEST_F(Containment, ACrashIsReportedBeforeTheSignalsDefaultAction) {
  if (kSanitizerTakesCrashesAndMemory) GTEST_SKIP() << "the sanitizer handles these signals itself";
  for (const auto& [fault, signal] : {std::pair("null", "SIGSEGV"),
                                      {"division", "SIGFPE"},
                                      {"illegal", "SIGILL"},
                                      {"abort", "SIGABRT"},
                                      {"stack", "SIGSEGV"}}) {
    const auto ended = run(fault);
    EXPECT_GT(ended.code, 1) << fault << ": the program that waits sees a signal";
    EXPECT_THAT(ended.err, AllOf(HasSubstr("instance 'b' at 400 ms"), HasSubstr(signal), HasSubstr("in fmi2DoStep")))
        << fault;
  }
}

TEST_F(Containment, AFaultWhenAnInstanceIsFreedFailsAndKeepsTheResults) {
  ASSERT_EQ(run("none").code, 0);
  const auto csv = result("results.csv");
  for (const auto& [fault, message] :
       {std::pair("free_exit", "instance 'b' at 1 s: its FMU called exit() in fmi2FreeInstance"),
        {"destructor_exit", "the library of the FMU probe.fmu called exit() while it was unloaded"},
        {"free_crash", "instance 'b' at 1000 ms: its FMU ended the process by SIGSEGV"},
        {"destructor", "the library of the FMU probe.fmu ended the process by SIGSEGV"}}) {
    const bool exits = std::string_view(fault).ends_with("exit");
    if (kSanitizerTakesCrashesAndMemory && !exits) continue;  // the sanitizer handles these signals
    const auto ended = run(fault);
    EXPECT_TRUE(exits ? ended.code == 1 : ended.code > 1) << fault << ": " << ended.code;
    EXPECT_THAT(ended.err, HasSubstr(message)) << fault;
    EXPECT_TRUE(result("results.csv") == csv) << fault;
    EXPECT_EQ(nlohmann::json::parse(result("summary.json"))["outcome"], exits ? "failed" : "completed") << fault;
  }
}

TEST_F(Containment, ChangesOfTheProcessByInitialisationAreReportedAndReverted) {
  const auto ended = run_program({"run", "two.json", "--set", "a.fault=meddle"}, folder.path());
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.err, AllOf(HasSubstr("the FMU probe.fmu changed the whole process in fmi2EnterInitializationMode"),
                               HasSubstr("file modes became 000 (put back to"),
                               HasSubstr("working directory became / (put back)"), HasSubstr("of core files"),
                               HasSubstr("descriptor 0 is closed (put back)"), HasSubstr("signal 10 (SIGUSR1)")));
  EXPECT_THAT(result("results.csv"), HasSubstr("\n1,")) << "the folder is relative to the working directory";
}

TEST_F(Containment, ReportsAndUndoesChangesOfTheEnvironment) {
  for (const std::string process : {"shared", "own"}) {
    write_file(folder.path() / "environment.json",
               with_probe(fmt::format(R"({{"step": 0.125, "stop_time": 1, "instances": {{
      "a": {{"fmu": "PROBE", "process": "{0}", "parameters": {{"fault": "set_environment"}}}},
      "b": {{"fmu": "PROBE", "process": "{0}", "parameters": {{"real_in": 0.5, "fault": "read_environment", "fault_time": 0.5}}}}}},
      "connections": [], "record": ["b.integral"]}})",
                                      process)));
    setenv("PROBE_HOME", "/somewhere", 1);
    const auto ended = run_program({"run", "environment.json"}, folder.path());
    unsetenv("PROBE_HOME");
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_THAT(ended.err, AllOf(HasSubstr("changed the whole process in fmi2EnterInitializationMode"),
                                 HasSubstr("environment variable PROBE_INTEGRAL became '7' (removed again)"),
                                 HasSubstr("environment variable TZ became 'PST8PDT'"),
                                 HasSubstr("environment variable PROBE_HOME was removed (put back)"),
                                 HasSubstr("environment variable PROBE_ENTRY became '1' (removed again)")));
    EXPECT_THAT(read_file(folder.path() / "results" / "environment" / "results.csv"), HasSubstr("\n1,0.5\n"))
        << "b integrates 0.5 and sees no PROBE_INTEGRAL";
  }
}

TEST(EnvironmentVariables, AreRestoredEvenIfTheWholeTableWasReplaced) {
  const auto before = master::EnvironmentVariables::now();
  ASSERT_NE(std::getenv("PATH"), nullptr);
  const std::string path = std::getenv("PATH");
  static char entry[] = "PATH=/nowhere";
  static std::array<char*, 2> table{entry, nullptr};
  environ = table.data();
  EXPECT_THAT(before.restore(), Not(testing::IsEmpty()));
  EXPECT_EQ(std::getenv("PATH"), path);
  EXPECT_THAT(before.restore(), testing::IsEmpty());
}

TEST_F(Containment, EveryInstanceIsWatched) {
  // b is the second instance of the FMU.
  const auto ended = run_program({"run", "two.json", "--set", "b.fault=meddle"}, folder.path());
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.err,
              AllOf(HasSubstr("b: warning: the FMU probe.fmu changed the whole process in fmi2EnterInitialization"),
                    HasSubstr("file modes became 000")));
}

TEST_F(Containment, AFileThatAnFmuOpensInItsStepsAndClosesAtTheEndIsItsOwn) {
  const auto ended = run("own_file");
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.err, Not(HasSubstr("changed")));
}

TEST_F(Containment, ChangesOfTheProcessByAStepAreReportedAndReverted) {
  // After step 4, each instance is checked separately, so the report names the instance. The next check is in step 8,
  // for all instances together, so the report of a change in step 5 names only the FMU.
  for (const auto& [time, who] :
       {std::pair("0.4", "b: warning: the FMU probe.fmu changed the whole process in fmi2DoStep"),
        {"0.5", "the FMU probe.fmu changed the whole process in steps from 0.4 s to 0.8 s"}}) {
    const auto ended =
        run_program({"run", "two.json", "--set", "b.fault=open_masks", "--set", std::string("b.fault_time=") + time},
                    folder.path());
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_THAT(ended.err, AllOf(HasSubstr(who), HasSubstr("file modes became 000 (put back to"))) << time;
  }
}

TEST_F(Containment, NamesTheFmuIfTheInstanceIsUnknown) {
  constexpr int kCount = 60;  // more than the number of instances that are checked individually
  std::string instances;
  for (int i = 0; i < kCount; ++i) instances += fmt::format(R"({}"i{}": {{"fmu": "PROBE"}})", i == 0 ? "" : ", ", i);
  write_file(
      folder.path() / "two.json",
      with_probe(R"({"step": 0.1, "stop_time": 1, "record": ["i0.integral"], "connections": [], "instances": {)" +
                 instances + "}}"));
  const auto ended = run_program({"run", "two.json", "--set", "i59.fault=meddle"}, folder.path());
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.err, AllOf(HasSubstr("the FMU probe.fmu changed the whole process in initialisation"),
                               HasSubstr("working directory became / (put back)")));
  EXPECT_THAT(result("results.csv"), HasSubstr("\n1,"));
  const auto freed = run_program({"run", "two.json", "--set", "i59.fault=free_meddle"}, folder.path());
  EXPECT_EQ(freed.code, 0) << freed.err;
  EXPECT_THAT(freed.err, AllOf(HasSubstr("the FMU probe.fmu changed the whole process when it was freed"),
                               HasSubstr("file modes became 000 (put back to")));
}

TEST_F(Containment, CodeInWhichAThreadRunsStaysInMemory) {
  const auto config = [](const std::string& fault) {
    return fmt::format(R"({{"step": 0.1, "stop_time": 1, "connections": [],
      "instances": {{"a": {{"fmu": "PROBE", "parameters": {{"fault": "{}", "fault_time": 0.5}}}}}}}})",
                       fault);
  };
  // Counts only new libraries, because other tests have left libraries in this process. After fmi2Fatal, a library also
  // stays loaded.
  const auto mapped = [] {
    std::istringstream maps(read_file("/proc/self/maps"));
    int count = 0;
    for (std::string line; std::getline(maps, line);) count += line.find("/probe.so") != std::string::npos ? 1 : 0;
    return count;
  };
  const auto before = mapped();
  TestRun(config("")).to_end();
  EXPECT_EQ(mapped(), before) << "without threads the library goes with the run";
  {
    TestRun run(config("thread_stays"));  // the thread executes code of the FMU for 0.1 s
    run.to_end();
  }
  EXPECT_GT(mapped(), before);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // an unloaded library would end this process
  const auto ended = run_program({"run", "two.json", "--set", "b.fault=thread_stays"}, folder.path());
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("that started after the FMU probe.fmu was loaded still run"))
      << "the thread sanitizer may have started one as well";
}

TEST_F(Containment, DoesNotReportAnFmuWithoutChanges) {
  EXPECT_THAT(run("").err, Not(HasSubstr("changed")));
}

TEST(ProcessState, AnFmuMayCloseWhatItOpened) {
  const auto of_others = master::open_files();
  const int opened = open("/dev/null", O_RDONLY | O_CLOEXEC);
  ASSERT_GE(opened, 0);
  const master::ProcessState knowing(of_others);
  const master::ProcessState ignorant;
  close(opened);
  EXPECT_THAT(knowing.put_right(), testing::IsEmpty());
  EXPECT_THAT(ignorant.put_right(), testing::ElementsAre(HasSubstr("is closed")));
}

TEST(ProcessState, AConnectionThatEndsIsNotReported) {
  const int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* const place = reinterpret_cast<sockaddr*>(&address);
  ASSERT_EQ(bind(listener, place, size), 0);
  ASSERT_EQ(listen(listener, 1), 0);
  ASSERT_EQ(getsockname(listener, place, &size), 0);
  const int client = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  ASSERT_EQ(connect(client, place, size), 0);
  const int served = accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
  ASSERT_GE(served, 0);
  const master::ProcessState state;
  close(served);
  close(client);
  EXPECT_THAT(state.put_right(), testing::IsEmpty());
  close(listener);
  EXPECT_THAT(state.put_right(), testing::ElementsAre(HasSubstr("is closed"))) << "the socket that waits for others";
}

TEST(FloatEnvironment, IsEachInstancesOwnAndAChangeIsReportedOnce) {
  const auto config = [](const std::string& fault) {
    return fmt::format(R"({{"step": 0.1, "stop_time": 10, "instances": {{
      "a": {{"fmu": "PROBE", "parameters": {{"real_in": 0.1}}}},
      "b": {{"fmu": "PROBE", "parameters": {{"real_in": 0.1, "fault": "{0}", "fault_time": 0.1}}}},
      "c": {{"fmu": "PROBE", "parameters": {{"real_in": 0.1, "fault": "{0}", "fault_time": 0.1}}}}}},
      "connections": [], "record": ["*.integral"]}})",
                       fault);
  };
  TestRun plain(config(""));
  plain.to_end();
  const auto before = master::FloatEnvironment::now();
  TestRun upward(config("upward"));
  upward.to_end();
  EXPECT_EQ(master::FloatEnvironment::now(), before);
  EXPECT_EQ(upward.column("a.integral"), plain.column("a.integral"));
  EXPECT_GT(upward.column("b.integral").back(), plain.column("b.integral").back()) << "its own sums go upward";
  const auto told = [](const std::string& line) { return line.find("rounding upward") != std::string::npos; };
  EXPECT_EQ(std::ranges::count_if(upward.messages.lines, told), 1) << "once for b and c, which are of one FMU";
}

TEST(FloatEnvironment, DifferencesAreNamed) {
  EXPECT_EQ(master::difference_text({0x1f80 | 0x6000, 0x037f}, {}), "rounding toward zero");
  EXPECT_EQ(master::difference_text({0x9fc0, 0x037f}, {}), "denormal numbers become 0");
  EXPECT_THAT(master::difference_text({0x1d80, 0x037b}, {}),
              AllOf(HasSubstr("exceptions end the process"), HasSubstr("0x037b")));
}

}  // namespace
}  // namespace mebots::test
