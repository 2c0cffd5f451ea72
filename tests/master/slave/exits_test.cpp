// SPDX-License-Identifier: Apache-2.0
// Tests FMUs in the master's process that change the thread, end the run, or fork the process. Each case must be
// reported with the name of the instance, and a failed run must have a non-zero exit code.
#include "fmi/call/exit_guard.hpp"
#include "fmi/call/forked_copies.hpp"
#include "fmi/process/process_state.hpp"
#include "mebots/mission.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <ctime>
#include <thread>

namespace mebots::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// Calls `change` and then `still` on a thread. Returns the report of ProcessState between both calls.
template <typename Change, typename Still>
std::vector<std::string> reported(Change change, Still still) {
  std::vector<std::string> texts;
  std::thread([&] {
    const master::ProcessState state;
    change();
    texts = state.put_right();
    still();
  }).join();
  return texts;
}

bool is_blocked(int signal) {
  sigset_t mask;
  pthread_sigmask(SIG_SETMASK, nullptr, &mask);
  return sigismember(&mask, signal) == 1;
}

TEST(ThreadState, AChangedSignalMaskIsReportedAndUndone) {
  const auto texts = reported(
      [] {
        sigset_t some;
        sigemptyset(&some);
        sigaddset(&some, SIGINT);
        sigaddset(&some, SIGUSR2);
        pthread_sigmask(SIG_BLOCK, &some, nullptr);
      },
      [] { EXPECT_FALSE(is_blocked(SIGINT) || is_blocked(SIGUSR2)); });
  EXPECT_THAT(texts, ElementsAre("the signal mask blocks SIGINT, SIGUSR2 (put back)"));
}

TEST(ThreadState, AMaskOfAllSignalsIsReportedInShort) {
  const auto texts = reported(
      [] {
        sigset_t all;
        sigfillset(&all);
        pthread_sigmask(SIG_SETMASK, &all, nullptr);
      },
      [] { EXPECT_FALSE(is_blocked(SIGTERM)); });
  EXPECT_THAT(texts,
              ElementsAre(AllOf(HasSubstr("SIGHUP, SIGINT, SIGQUIT, SIGILL and "), HasSubstr(" more (put back)"))));
}

TEST(ThreadState, PriorityAffinityStackAndParentDeathSignalAreReported) {
  const auto nice_before = getpriority(PRIO_PROCESS, 0);
  stack_t stack_before{};
  const auto texts = reported(
      [&] {
        static std::array<char, 1 << 16> memory;
        stack_t stack{};
        stack.ss_sp = memory.data();
        stack.ss_size = memory.size();
        sigaltstack(&stack, &stack_before);
        setpriority(PRIO_PROCESS, 0, nice_before + 3);
        prctl(PR_SET_PDEATHSIG, SIGUSR2);
      },
      [&] {
        stack_t stack{};
        sigaltstack(nullptr, &stack);
        EXPECT_EQ(stack.ss_sp, stack_before.ss_sp);
        int signal = -1;
        prctl(PR_GET_PDEATHSIG, &signal);
        EXPECT_EQ(signal, 0);
      });
  EXPECT_THAT(texts, Contains("the alternate signal stack changed (put back)"));
  EXPECT_THAT(texts, Contains("the parent-death signal became SIGUSR2 (put back)"));
  EXPECT_THAT(texts, Contains(HasSubstr(fmt::format("the priority (nice value) became {}", nice_before + 3))));
}

TEST(ThreadState, AThreadThatChangesNothingIsNotReported) {
  EXPECT_THAT(reported([] {}, [] {}), IsEmpty());
}

bool timer_runs(int which) {
  itimerval timer{};
  getitimer(static_cast<__itimer_which_t>(which), &timer);
  return timer.it_value.tv_sec != 0 || timer.it_value.tv_usec != 0;
}

void start_timer(int which) {
  itimerval later{};
  later.it_value.tv_sec = 1000;
  setitimer(static_cast<__itimer_which_t>(which), &later, nullptr);
}

TEST(TimerState, ATimerWhoseSignalWouldEndTheProcessIsStopped) {
  const master::ProcessState state;
  start_timer(ITIMER_REAL);
  start_timer(ITIMER_PROF);
  EXPECT_THAT(state.put_right(), ElementsAre("the timer ITIMER_REAL, as by alarm(), runs (stopped)",
                                             "the timer ITIMER_PROF runs (stopped)"));
  EXPECT_FALSE(timer_runs(ITIMER_REAL) || timer_runs(ITIMER_PROF));
  EXPECT_THAT(state.put_right(), IsEmpty());
}

TEST(TimerState, ATimerWhoseSignalHasAHandlerStaysAndIsReportedOnce) {
  std::signal(SIGVTALRM, [](int) {});
  const master::ProcessState state;
  start_timer(ITIMER_VIRTUAL);
  EXPECT_THAT(state.put_right(), ElementsAre(HasSubstr("ITIMER_VIRTUAL runs (left running")));
  EXPECT_TRUE(timer_runs(ITIMER_VIRTUAL));
  EXPECT_THAT(state.put_right(), IsEmpty());
  master::stop_timers_of(SIGVTALRM);
  std::signal(SIGVTALRM, SIG_DFL);
  EXPECT_FALSE(timer_runs(ITIMER_VIRTUAL));
}

TEST(TimerState, ATimerOfTheProgramIsNotReported) {
  start_timer(ITIMER_REAL);
  const master::ProcessState state;
  EXPECT_THAT(state.put_right(), IsEmpty());
  EXPECT_TRUE(timer_runs(ITIMER_REAL));
  master::stop_timers_of(SIGALRM);
}

TEST(TimerState, ACreatedTimerIsDeletedWhenItsSignalWouldEndTheProcess) {
  if (access("/proc/self/timers", R_OK) != 0) GTEST_SKIP() << "this kernel does not list timers";
  const master::ProcessState state;
  sigevent event{};
  event.sigev_notify = SIGEV_SIGNAL;
  event.sigev_signo = SIGRTMIN + 1;
  timer_t timer{};
  ASSERT_EQ(timer_create(CLOCK_MONOTONIC, &event, &timer), 0);
  EXPECT_THAT(state.put_right(), ElementsAre(HasSubstr("was made by timer_create() (stopped)")));
  itimerspec none{};
  EXPECT_EQ(timer_settime(timer, 0, &none, nullptr), -1) << "it is gone";
}

TEST(ProcessState, TheHandlersThatEndARunArePutBack) {
  const auto before = std::signal(SIGINT, SIG_DFL);
  const master::ProcessState state;
  std::signal(SIGINT, SIG_IGN);
  EXPECT_THAT(state.put_right(), ElementsAre("the handler of signal 2 (SIGINT) changed (put back)"));
  EXPECT_EQ(std::signal(SIGINT, before), SIG_DFL);
}

class Exits : public testing::Test {
 protected:
  Exits() {
    write_file(folder.path() / "two.json", with_probe(R"({"step": 0.1, "stop_time": 1, "instances": {
      "a": {"fmu": "PROBE", "parameters": {"real_in": 0.1}}, "b": {"fmu": "PROBE"}},
      "connections": [{"from": "b.string_out", "to": "a.string_in"}], "record": ["*.integral"]})"));
  }
  ProgramResult run(const std::string& fault, const std::string& more = "") const {
    std::vector<std::string> arguments{"run", "two.json", "--set", "b.fault=" + fault, "--set", "b.fault_time=0.5"};
    if (!more.empty()) arguments.push_back(more);
    return run_program(arguments, folder.path());
  }
  std::string result(const std::string& file) const { return read_file(folder.path() / "results" / "two" / file); }
  nlohmann::json summary() const { return nlohmann::json::parse(result("summary.json")); }
  void expect_results_until(const std::string& last, const std::string& first_missing) const {
    EXPECT_THAT(result("results.csv"), AllOf(HasSubstr("\n" + last + ","), Not(HasSubstr("\n" + first_missing + ","))));
  }

  modeldesc::TemporaryFolder folder{"mebots-test"};
};

TEST_F(Exits, AnEndOfTheThreadOrOfTheProcessFailsTheRunWithItsResults) {
  for (const auto& [fault, what] : {std::pair("pthread_exit", "its FMU ended the thread that called it (pthread_exit"),
                                    {"enabled_cancel", "its FMU ended the thread that called it (pthread_exit"},
                                    {"exec", "its FMU called execl()"},
                                    {"alarm", "its FMU caused the signal SIGALRM"},
                                    {"usr1", "its FMU caused the signal SIGUSR1"}}) {
    const auto ended = run(fault);
    EXPECT_EQ(ended.code, 1) << fault;
    EXPECT_THAT(ended.err, AllOf(HasSubstr("instance 'b' at 0.4 s"), HasSubstr(what), HasSubstr("in fmi2DoStep"),
                                 HasSubstr("--isolate")))
        << fault;
    EXPECT_EQ(summary()["outcome"], "failed") << fault;
    EXPECT_THAT(summary()["error"].get<std::string>(), HasSubstr("instance 'b'")) << fault;
    expect_results_until("0.4", "0.5");
  }
}

TEST_F(Exits, ASignalOfATimerThatALaterStepMeetsFailsTheRun) {
  const auto ended = run("alarm_later");
  EXPECT_EQ(ended.code, 1);
  EXPECT_THAT(ended.err, AllOf(HasSubstr("the signal SIGALRM"), HasSubstr("b")));
  EXPECT_EQ(summary()["outcome"], "failed");
  EXPECT_THAT(result("results.csv"), AllOf(HasSubstr("\n0.4,"), Not(HasSubstr("\n1,"))));
}

TEST(ExitGuard, ASignalBetweenCallsIsKeptForTheThreadThatSteps) {
  master::take_kept_signal();
  EXPECT_FALSE(master::end_by_signal(SIGALRM)) << "without a run it takes its course";
  bool busy = true;
  const master::ExitGuard guard(busy, [](const std::string&) {});
  EXPECT_TRUE(master::end_by_signal(SIGALRM));
  const auto text = master::take_kept_signal();
  ASSERT_TRUE(text.has_value());
  EXPECT_THAT(*text, HasSubstr("the signal SIGALRM"));
  EXPECT_FALSE(master::take_kept_signal().has_value());
  busy = false;  // NOLINT(clang-analyzer-deadcode.DeadStores): the guard refers to it
  EXPECT_FALSE(master::end_by_signal(SIGALRM));
}

TEST_F(Exits, ACancelledThreadContinues) {
  ASSERT_EQ(run("none").code, 0);
  const auto csv = result("results.csv");
  const auto ended = run("cancel");
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(result("results.csv"), csv);
}

TEST_F(Exits, AForkedCopyThatReturnsIsEndedAndTheRunIsWholeButFails) {
  ASSERT_EQ(run("none").code, 0);
  const auto csv = result("results.csv");
  const auto lines = [](const std::string& text) { return std::ranges::count(text, '\n'); };
  const auto log_lines = lines(result("log.txt"));
  for (const std::string fault : {"fork_returns", "vfork_returns"}) {
    const auto ended = run(fault);
    EXPECT_EQ(ended.code, 1) << fault;
    EXPECT_THAT(ended.err, AllOf(HasSubstr("instance 'b' at 400 ms: its FMU forked the process in fmi2DoStep"),
                                 HasSubstr("returned from the call")))
        << fault;
    EXPECT_EQ(result("results.csv"), csv) << fault;
    EXPECT_LE(lines(result("log.txt")), log_lines + 1) << fault << ": the copy wrote nothing";
    EXPECT_EQ(summary()["outcome"], "completed") << fault;
    EXPECT_THAT(summary()["notices"].dump(), HasSubstr("instance 'b'")) << fault;
  }
}

TEST_F(Exits, ACppExceptionIsAnErrorOfItsInstance) {
  for (const auto& [fault, what] :
       {std::pair("throw", "std::domain_error (the solver diverged)"), {"throw_number", "int"}}) {
    const auto ended = run(fault);
    EXPECT_EQ(ended.code, 1) << fault;
    EXPECT_THAT(ended.err,
                HasSubstr(fmt::format("instance 'b' at 0.4 s: fmi2DoStep threw {} through its C interface", what)));
    EXPECT_EQ(summary()["outcome"], "failed") << fault;
    expect_results_until("0.4", "0.5");
  }
  const auto early = run("early_throw");
  EXPECT_EQ(early.code, 2);
  EXPECT_THAT(early.err, HasSubstr("instance 'b' at 0 s: fmi2EnterInitializationMode threw std::domain_error"));
  const auto late = run("free_throw");
  EXPECT_EQ(late.code, 1);
  EXPECT_THAT(late.err, HasSubstr("fmi2FreeInstance threw std::domain_error"));
  EXPECT_THAT(result("results.csv"), HasSubstr("\n1,"));
}

TEST_F(Exits, ATextAtAnAddressWhereNothingIsIsAnErrorOfItsInstance) {
  for (const std::string process : {"", "--isolate"}) {
    const auto ended = run("bad_string", process);
    EXPECT_EQ(ended.code, 1) << process;
    EXPECT_THAT(ended.err, HasSubstr("fmi2GetString returned the address 0x8 for the text of string_out")) << process;
    EXPECT_THAT(ended.err, HasSubstr("instance 'b' at 0.5 s")) << process;
    EXPECT_EQ(summary()["outcome"], "failed") << process;
  }
}

TEST_F(Exits, ReportsChangesOfThreadAndTimersWithTheInstance) {
  const auto ended = run("meddle_thread");
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.err,
              AllOf(HasSubstr("b: warning: the FMU probe.fmu changed the whole process in fmi2EnterInitialization"),
                    HasSubstr("the signal mask blocks SIGINT, SIGTERM (put back)"),
                    HasSubstr("the handler of signal 2 (SIGINT) changed (put back)"),
                    HasSubstr("ITIMER_REAL, as by alarm(), runs (stopped)"), HasSubstr("ITIMER_PROF runs (stopped)"),
                    HasSubstr("the priority (nice value) became"), HasSubstr("the parent-death signal became SIGUSR2"),
                    HasSubstr("the alternate signal stack changed (put back)")));
  EXPECT_THAT(result("results.csv"), HasSubstr("\n1,"));
}

TEST_F(Exits, BlockedSignalsAreUnblockedWithinSixtyFourSteps) {
  // The fault is in step 140 of 300. The next check is after step 256.
  const auto ended = run_program(
      {"run", "two.json", "--set", "b.fault=block", "--set", "b.fault_time=14", "--stop-time", "30"}, folder.path());
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_THAT(ended.err, AllOf(HasSubstr("in steps from 12.8 s to 19.2 s: the signal mask blocks"), HasSubstr("'b'")));
}

TEST_F(Exits, MessagesBeyondTheLimitOfACallAreCountedInAnyProcess) {
  constexpr int kMessages = 600;
  const std::string frame(64, 'x');
  for (const std::string process : {"", "--isolate"}) {
    const auto ended = run("log_flood", process);
    EXPECT_EQ(ended.code, 0) << process;
    const auto log = result("log.txt");
    std::istringstream stream(log);
    int kept = 0;
    int dropped = 0;
    for (std::string line; std::getline(stream, line);) {
      if (line.find(frame) != std::string::npos) ++kept;
      const auto at = line.find(" more messages of this call were dropped");
      if (at == std::string::npos) continue;
      EXPECT_THAT(line, HasSubstr("b: warning: "));
      dropped = std::stoi(line.substr(line.rfind(' ', at - 1) + 1));
    }
    EXPECT_EQ(kept + dropped, kMessages) << process;
    EXPECT_GT(dropped, 0) << process;
    EXPECT_GE(kept, 500) << process;
  }
}

std::string pending_config(const std::string& process, const std::string& behaviour, const std::string& more = "") {
  return fmt::format(R"({{"step": 0.1, "stop_time": 0.2, "instances": {{
      "a": {{"fmu": "COUPLING", "process": "{}", "parameters": {{"behaviour": "{}", "pause": 0.002}}{}}},
      "b": {{"fmu": "COUPLING"}}}}, "connections": [{{"from": "a.ramp_out", "to": "b.ramp_in"}}]}})",
                     process, behaviour, more);
}

TEST(PendingInAProcessOfItsOwn, GivesTheSameBytesAsInTheMastersProcess) {
  if (!sandbox_refusal().empty()) GTEST_SKIP() << sandbox_refusal();
  for (const char* behaviour : {"callback", "poll"}) {
    TestRun shared(pending_config("shared", behaviour));
    shared.to_end();
    EXPECT_THAT(shared.column("a.steps"), ElementsAre(0, 1, 2)) << behaviour;
    for (const char* process : {"own", "sandboxed"}) {
      TestRun run(pending_config(process, behaviour));
      run.to_end();
      EXPECT_EQ(run.csv(), shared.csv()) << process << " " << behaviour;
    }
  }
}

TEST(PendingInAProcessOfItsOwn, ALateDiscardIsADiscard) {
  TestRun run(pending_config("own", "late_discard"));
  try {
    run.to_end();
    FAIL();
  } catch (const master::SlaveError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("instance 'a' at 0 s"), HasSubstr("fmi2Discard")));
  }
}

TEST(PendingInAProcessOfItsOwn, AnInterruptCancelsTheStepAndTheInstanceIsTerminated) {
  if (!sandbox_refusal().empty()) GTEST_SKIP() << sandbox_refusal();
  for (const char* process : {"own", "sandboxed"}) {
    TestRun run(pending_config(process, "never"));
    run.initialize();
    std::jthread user([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      run.interrupted = true;
    });
    EXPECT_EQ(run.simulation().run().reason, EndReason::interrupted) << process;
    EXPECT_NO_THROW(run.simulation().terminate()) << process << ": fmi2CancelStep was called, and the process lives";
  }
}

TEST(PendingInAProcessOfItsOwn, AStepThatNeverEndsMeetsItsDeadline) {
  TestRun run(pending_config("own", "never", R"(, "deadline": 0.2)"));
  run.initialize();
  try {
    run.simulation().run();
    FAIL();
  } catch (const master::SlaveError& error) {
    EXPECT_EQ(error.code(), ErrorCode::fmu_timeout);
    EXPECT_THAT(error.what(), AllOf(HasSubstr("instance 'a' at 0 s: fmi2DoStep"), HasSubstr("deadline of 0.2 s")));
  }
}

TEST(PendingInAProcessOfItsOwn, OthersContinueWithoutAnInstanceThatIsLostWhileItsStepIsPending) {
  modeldesc::TemporaryFolder folder{"mebots-test"};
  write_file(folder.path() / "run.json",
             with_probe(pending_config("own", "never", R"(, "deadline": 0.2, "on_failure": "continue")")));
  const auto ended = run_program({"run", "run.json"}, folder.path());
  EXPECT_EQ(ended.code, 0) << ended.err;
  const auto summary = nlohmann::json::parse(read_file(folder.path() / "results" / "run" / "summary.json"));
  EXPECT_TRUE(summary["lost_instances"].contains("a"));
}

/// Runs a mission in an embedding program. If an FMU ends its thread or the process, the program must have a non-zero
/// exit code.
class ExitsOfPrograms : public testing::Test {
 protected:
  void fly(const std::string& fault) const {
    write_file(folder.path() / "one.json", with_probe(R"({"step": 0.1, "stop_time": 1, "connections": [],
      "instances": {"b": {"fmu": "PROBE"}}})"));
    Mission mission(folder.path() / "one.json");
    mission.set("b.fault", fault);
    mission.set("b.fault_time", 0.5);
    mission.run();
  }
  modeldesc::TemporaryFolder folder{"mebots-test"};
};

TEST_F(ExitsOfPrograms, AnEndOfTheThreadAndASignalEndTheProgramWithCode1) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  for (const std::string fault : {"pthread_exit", "exit", "alarm", "usr1"}) {
    EXPECT_EXIT(
        {
          fly(fault);
          std::exit(0);
        },
        testing::ExitedWithCode(1), "instance 'b' at 0.4 s")
        << fault;
  }
}

TEST_F(ExitsOfPrograms, AnExceptionOfTheFmuIsAnErrorOfTheMission) {
  try {
    fly("throw");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("instance 'b' at 0.4 s: fmi2DoStep threw std::domain_error"));
  }
}

TEST_F(ExitsOfPrograms, AProgramMayForkBetweenSteps) {
  write_file(folder.path() / "one.json", with_probe(R"({"step": 0.1, "stop_time": 1, "connections": [],
    "instances": {"b": {"fmu": "PROBE"}}})"));
  Mission mission(folder.path() / "one.json");
  mission.run_until(0.5);
  const auto child = fork();
  if (child == 0) {
    mission.run();
    _exit(mission.time_s() == 1 && !master::is_forked_copy() ? 7 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 7) << "the copy is a run of its own";
  mission.run();
  EXPECT_EQ(mission.time_s(), 1);
}

}  // namespace
}  // namespace mebots::test
