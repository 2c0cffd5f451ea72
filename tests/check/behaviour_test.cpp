// SPDX-License-Identifier: Apache-2.0
#include "child.hpp"
#include "fmi/call/callbacks.hpp"
#include "support.hpp"
#include "support/sanitizer.hpp"

#include <gmock/gmock.h>

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <new>
#include <string>
#include <thread>

#include <nlohmann/json.hpp>

namespace mebots::check {
namespace {

using test::kSanitizerTakesCrashesAndMemory;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> of(const std::string& crime, double deadline_s = 30, Level level = Level::pedantic) {
  Workshop workshop;
  return findings(workshop.culprit(crime), true, deadline_s, level);
}

TEST(CheckBehaviour, AnFmuThatDoesRightHasNoFindings) {
  EXPECT_THAT(of("none"), IsEmpty());
  EXPECT_THAT(findings(LAG_FMU, true), IsEmpty());
}

TEST(CheckBehaviour, WrongValuesAreFound) {
  EXPECT_THAT(of("start"),
              Contains(HasSubstr("error: gain is 3 in initialisation mode; modelDescription.xml declares start 2")));
  EXPECT_THAT(of("nan"), Contains(HasSubstr("error: y is nan at 0.1 s")));
  EXPECT_THAT(of("limits"), Contains(HasSubstr("warning: y = 1000 at 0.1 s is outside of its min and max")));
  EXPECT_THAT(of("coarse"), Contains(HasSubstr("after twice as many half steps")));
}

TEST(CheckBehaviour, AnFmuThatDependsOnTheStopTimeIsFound) {
  // The FMU computes y(h) = gain (1 - e^-h) with the stop time as its gain. The default stop time is 2 in the first
  // description, and 1 in the second.
  EXPECT_THAT(of("stop"), IsEmpty());
  Workshop workshop;
  auto description = culprit_description("stop");
  const std::string stop = "stopTime=\"2\"";
  description.replace(description.find(stop), stop.size(), "stopTime=\"1\"");
  EXPECT_THAT(
      findings(workshop.culprit_with(description), true, 30, Level::interoperable),
      testing::ElementsAre(testing::AllOf(
          HasSubstr("warning: values depend on the stop time: at 0.1 s, with stopTime 1 s compared with none, y "),
          HasSubstr("is 0.0951"), HasSubstr("instead of 0.1903"))));
  EXPECT_THAT(findings(EXPERIMENT_FMU, true, 30, Level::interoperable),
              Contains(HasSubstr("at 0 s, with stopTime 2 s compared with none, stop is 2 instead of 0")));
}

TEST(CheckBehaviour, AnFmuThatNeedsAStopTimeGetsOne) {
  EXPECT_THAT(of("needs_stop", 30, Level::standard),
              testing::ElementsAre(HasSubstr("error: it needs a stop time, and most tools pass none: "
                                             "fmi2SetupExperiment returned fmi2Error: no stop time")));
}

TEST(CheckBehaviour, StateThatLeaksBetweenRunsAndInstancesIsFound) {
  EXPECT_THAT(of("global"), Contains(HasSubstr("error: next to another instance: y is")));
  EXPECT_THAT(of("reset"), Contains(HasSubstr("error: after fmi2Reset after some steps: y is")));
  EXPECT_THAT(of("state"), Contains(HasSubstr("error: after fmi2SetFMUstate: y is")));
  EXPECT_THAT(of("bytes"), Contains(HasSubstr("error: after restoring a serialised state in another instance: y is")));
}

TEST(CheckBehaviour, CountsResourcesThatAreNotReleased) {
  if (kSanitizerTakesCrashesAndMemory) GTEST_SKIP() << "it owns malloc, which the check asks for its count";
  EXPECT_THAT(of("leak"),
              Contains(testing::ContainsRegex("100 instances were freed and leaked 1[0-9]{5} bytes of heap")));
  EXPECT_THAT(of("file"), Contains(HasSubstr("100 instances were freed and leaked 100 open files")));
}

TEST(CheckBehaviour, IllegalCallsThatAreAcceptedAreFound) {
  EXPECT_THAT(of("order"), Contains(HasSubstr("warning: fmi2DoStep before initialisation returned fmi2OK")));
  EXPECT_THAT(of("fixed"),
              Contains(HasSubstr("setting the fixed parameter gain after initialisation returned fmi2OK")));
}

TEST(CheckBehaviour, ACrashIsAFindingThatNamesSignalAndCall) {
  if (kSanitizerTakesCrashesAndMemory) GTEST_SKIP() << "it answers a crash's signal before the check can";
  EXPECT_THAT(
      of("crash"),
      Contains(HasSubstr("error: crashed with SIGSEGV (Segmentation fault) in fmi2DoStep before initialisation")));
  EXPECT_THAT(of("null"), Contains(HasSubstr("SIGSEGV (Segmentation fault) in fmi2GetReal with null arrays")));
  EXPECT_THAT(of("free"), Contains(HasSubstr("SIGABRT (Aborted) in fmi2FreeInstance in initialisation mode")));
}

TEST(CheckBehaviour, AnFmuThatEndsTheProcessOrHangsIsAFinding) {
  EXPECT_THAT(of("exit"),
              Contains(HasSubstr("error: ended the process with exit code 3 in fmi2DoStep(t = 0, h = 0.1)")));
  EXPECT_THAT(of("hang", 0.2), Contains(HasSubstr("fmi2DoStep(t = 0, h = 0.1) did not return within 0.2 s")));
  EXPECT_THAT(of("sleep", 0.2), Contains(HasSubstr("fmi2DoStep(t = 0, h = 0.1) did not return within 0.2 s")));
}

TEST(CheckBehaviour, LevelsSelectTheReportedFindings) {
  const auto refused = HasSubstr("fmi2DoStep before initialisation returned fmi2OK");
  EXPECT_THAT(of("order", 30, Level::pedantic), Contains(refused));
  EXPECT_THAT(of("order", 30, Level::standard), IsEmpty());
  EXPECT_THAT(of("null", 30, Level::standard), IsEmpty());
  EXPECT_THAT(of("start", 30, Level::standard), Contains(HasSubstr("gain is 3")));
  EXPECT_THAT(of("start", 30, Level::interoperable), IsEmpty());
  EXPECT_THAT(of("nan", 30, Level::interoperable), Contains(HasSubstr("y is nan")));
}

TEST(CheckBehaviour, FindingsThatAreNotReportedAreCounted) {
  Workshop workshop;
  Options options;
  options.run = false;
  const auto report = check_fmu(workshop.culprit("none", {{"notes.txt", "x"}}), options);
  EXPECT_TRUE(report.clean());
  EXPECT_EQ(report.hidden_findings, 1);
  EXPECT_THAT(to_text(report), HasSubstr("clean at level standard; 1 more at a higher --level"));
}

TEST(CheckBehaviour, ChecksTheSharedStateOfTheProcessAfterEveryCall) {
  EXPECT_THAT(of("umask", 30, Level::interoperable),
              testing::ElementsAre(testing::AllOf(HasSubstr("warning: fmi2DoStep at 0.3"),
                                                  HasSubstr("the mask of file modes became 000"))));
  EXPECT_THAT(of("rounding", 30, Level::interoperable),
              Contains(testing::AllOf(
                  HasSubstr("warning: fmi2Instantiate: the floating-point environment of the thread changed"),
                  HasSubstr("rounding upward"))));
}

TEST(CheckBehaviour, AnFmuMayEndTheRun) {
  Workshop workshop;
  const auto with_trace = [&](const std::string& out) {
    return findings(workshop.culprit("ends", {{"documentation/reference/culprit_out.csv", out}}), true, 30,
                    Level::standard);
  };
  EXPECT_THAT(with_trace("time,y\n0,0\n1.5,1.5537396797031404\n"), IsEmpty());
  EXPECT_THAT(with_trace("time,y\n0,0\n1.5,1.5537396797031404\n2,1.8\n"),
              Contains(HasSubstr("the FMU ended the run at 1.5 s, before the end of the trace")));
}

class CrashingListener final : public master::CallbackListener {
 public:
  void logged(master::LoggerCall /*call*/) override { std::raise(SIGSEGV); }
  void step_finished(int /*status*/) override {}
};

TEST(CheckBehaviour, ACrashInACallbackOfOursIsNotTheFmus) {
  if (kSanitizerTakesCrashesAndMemory) GTEST_SKIP() << "it answers a crash's signal before the check can";
  Check check;
  const auto crash = [](Witness& witness) {
    CrashingListener listener;
    master::CallbackTarget target(listener, "it");
    const auto callbacks = target.functions(false);
    const master::CallbackScope scope(target, "fmi2DoStep", 0);
    witness.doing("fmi2DoStep");
    callbacks.logger(callbacks.componentEnvironment, "it", fmi2OK, "", "hello");
  };
  try {
    run_in_child({}, check, crash);
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("callback logger"), HasSubstr("called in fmi2DoStep")));
  }
  EXPECT_TRUE(check.findings.empty());
}

TEST(CheckBehaviour, MemoryThatTheFmuDamagedIsItsOwnMistakeWhereverItShows) {
  if (kSanitizerTakesCrashesAndMemory) GTEST_SKIP() << "it ends the process where the damage is done";
  EXPECT_THAT(of("heap"), Contains(testing::ContainsRegex("error: crashed with SIG[A-Z]+ .* in fmi2DoStep")));
  EXPECT_THAT(of("foreign_free"),
              Contains(HasSubstr("error: freeMemory was called with a pointer that allocateMemory")));
}

/// True if the process runs; false if it is a zombie.
bool runs(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  const auto name_end = text.rfind(')');
  return name_end != std::string::npos && text[name_end + 2] != 'Z' && text[name_end + 2] != 'X';
}

bool ends_soon(pid_t process) {
  for (int i = 0; i < 100 && runs(process); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  return !runs(process);
}

/// Memory in which child processes store their process ids for the parent.
struct Left {
  std::atomic<pid_t> child;
  std::atomic<pid_t> child_of_child;
  std::atomic<pid_t> daemon;  ///< in a new session, without a parent
};

[[noreturn]] void stay() {
  for (;;) pause();
}

void leave_processes(Left& left) {
  left.child = getpid();
  if (const auto child = fork(); child != 0) {
    left.child_of_child = child;
  } else {
    stay();
  }
  const auto between = fork();
  if (between != 0) {
    waitpid(between, nullptr, 0);
    return;
  }
  setsid();
  const auto daemon = fork();
  if (daemon == 0) stay();
  left.daemon = daemon;
  _exit(0);
}

TEST(CheckBehaviour, EndsProcessesOfTheFmuAfterTheCheck) {
  auto* const memory = mmap(nullptr, sizeof(Left), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  auto& left = *new (memory) Left{};
  const auto all_end = [&left] {
    return left.daemon > 0 && ends_soon(left.child) && ends_soon(left.child_of_child) && ends_soon(left.daemon);
  };
  Check check;
  run_in_child({}, check, [&](Witness&) { leave_processes(left); });
  EXPECT_TRUE(check.findings.empty());
  EXPECT_TRUE(all_end());

  run_in_child({Severity::error, "", 0.2}, check, [&](Witness&) {
    leave_processes(left);
    stay();
  });
  EXPECT_EQ(check.findings.size(), 1U) << "no answer";
  EXPECT_TRUE(all_end());

  left.daemon = 0;
  const auto checker = fork();
  if (checker == 0) {
    Check unread;
    run_in_child({}, unread, [&](Witness&) {
      leave_processes(left);
      stay();
    });
    _exit(0);
  }
  for (int i = 0; i < 500 && left.daemon == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  kill(checker, SIGKILL);
  waitpid(checker, nullptr, 0);
  EXPECT_TRUE(all_end()) << "with a check that is killed, too";
  munmap(memory, sizeof(Left));
}

TEST(CheckBehaviour, TheLoggersArgumentsAreLookedAt) {
  EXPECT_THAT(of("name"),
              Contains(HasSubstr("the logger was called with the instance name \"somebody\" instead of \"illegal\"")));
  EXPECT_THAT(of("category"),
              Contains(HasSubstr("a message is of category \"gossip\", which LogCategories does not list")));
}

TEST(CheckBehaviour, ReferenceTracesAreReplayed) {
  Workshop workshop;
  const auto with_trace = [&](const std::string& out) {
    return findings(workshop.culprit("none", {{"documentation/reference/culprit_in.csv", "time,u\n0,0\n1,3\n"},
                                              {"documentation/reference/culprit_out.csv", out}}),
                    true);
  };
  // One second after u became 3, y is 6 (1 - exp(-1)).
  EXPECT_THAT(with_trace("time,y\n0,0\n1,0\n2,3.792723352971346\n"), IsEmpty());
  EXPECT_THAT(
      with_trace("time,y\n0,0\n1,0\n2,3.9\n"),
      Contains(HasSubstr("culprit_out.csv: first divergence at 2 s: y is 3.792723352971346, the trace has 3.9")));
  EXPECT_THAT(with_trace("time,z\n0,0\n"),
              Contains(HasSubstr("column 2 ('z'): this is not a numeric variable of this FMU")));
}

TEST(CheckBehaviour, TracesOfTheLayeredStandardAreReplayed) {
  Workshop workshop;
  const auto fmu_with_trace = [&](const std::string& out) {
    const std::string folder = "extra/org.fmi-standard.fmi-ls-ref/";
    return workshop.culprit(
        "none", {{folder + "fmi-ls-manifest.xml",
                  R"(<fmiReferences><Related type="text/csv" source="it_out.csv" role="result"/></fmiReferences>)"},
                 {folder + "it_out.csv", out}});
  };
  const auto with_trace = [&](const std::string& out) { return findings(fmu_with_trace(out), true); };
  // For u = 1, y is 2 (1 - exp(-1)). The traces are for FMI 2.0 and FMI 3.0, so columns of the other version are
  // ignored.
  EXPECT_THAT(with_trace("time,binary,y\n0,666f6f,0\n1,666f6f,1.2642411176571153\n"), IsEmpty());
  EXPECT_THAT(with_trace("time,y\n0,0\n1,1.3\n"), Contains(HasSubstr("it_out.csv: first divergence at 1 s")));
  const auto check_of = [&](const std::string& out) {
    const auto report = check_fmu(fmu_with_trace(out), {});
    return *std::ranges::find_if(report.checks,
                                 [](const Check& check) { return check.name.starts_with("reference traces"); });
  };
  EXPECT_THAT(check_of("time,binary,y\n0,666f6f,0\n").name, HasSubstr("in 1 of 2 columns"));
  EXPECT_THAT(check_of("time,binary\n0,666f6f\n").skipped, HasSubstr("it_out.csv has no column with numbers"));
}

TEST(CheckBehaviour, MissingLibrariesAndForeignBinariesAreNamed) {
  Workshop workshop;
  EXPECT_THAT(findings(workshop.described(culprit_description("none")), true),
              Contains(HasSubstr("is no library of a known platform")));
}

TEST(CheckReport, IsValidJson) {
  Workshop workshop;
  const auto report = check_fmu(workshop.culprit("nan"), {});
  const auto json = nlohmann::json::parse(to_json(report));
  EXPECT_FALSE(json.at("clean"));
  EXPECT_GT(json.at("errors"), 0);
  bool found = false;
  for (const auto& check : json.at("checks"))
    for (const auto& finding : check.at("findings")) found = found || finding.at("text") == "y is nan at 0.1 s";
  EXPECT_TRUE(found);
  EXPECT_THAT(to_text(report), HasSubstr("y is nan at 0.1 s\n           -> "));
}

}  // namespace
}  // namespace mebots::check
