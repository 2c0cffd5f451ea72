// SPDX-License-Identifier: Apache-2.0
// What an FMU does to the process that it shares with the master and the other FMUs: told, with its name, and kept from
// them where it can be.
#include "slave/float_environment.hpp"
#include "slave/process_state.hpp"
#include "test_system.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>

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

TEST_F(Containment, ACrashIsToldBeforeTheSignalTakesItsCourse) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer handles these signals itself";
#endif
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

TEST_F(Containment, WhatInitialisationChangesInTheProcessIsToldAndPutBack) {
  const auto ended = run_program({"run", "two.json", "--set", "a.fault=meddle"}, folder.path());
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.err,
              AllOf(HasSubstr("the FMU probe.fmu changed the process for all, in fmi2EnterInitializationMode"),
                    HasSubstr("file modes became 000 (put back to"), HasSubstr("working directory became / (put back)"),
                    HasSubstr("of core files"), HasSubstr("descriptor 0 is closed (put back)"),
                    HasSubstr("signal 10 (SIGUSR1)")));
  EXPECT_THAT(result("results.csv"), HasSubstr("\n1,")) << "the folder is relative to the working directory";
}

TEST_F(Containment, AnFmuThatChangesNothingIsNotSpokenOf) {
  EXPECT_THAT(run("").err, Not(HasSubstr("changed")));
}

TEST(ProcessState, AnFmuMayCloseWhatItOpened) {
  const master::ProcessState before;
  const int opened = open("/dev/null", O_RDONLY | O_CLOEXEC);
  ASSERT_GE(opened, 0);
  const auto own = before.opened();
  EXPECT_EQ(own.size(), 1U);
  const master::ProcessState knowing(own);
  const master::ProcessState ignorant;
  EXPECT_EQ(knowing.opened().count(opened), 1U) << "still its own";
  close(opened);
  EXPECT_THAT(knowing.put_right(), testing::IsEmpty());
  EXPECT_THAT(ignorant.put_right(), testing::ElementsAre(HasSubstr("is closed")));
}

TEST(FloatEnvironment, IsEachInstancesOwnAndAChangeIsToldOnce) {
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
