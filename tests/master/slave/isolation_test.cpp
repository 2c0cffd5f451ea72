// SPDX-License-Identifier: Apache-2.0
// Tests that FMUs in separate processes compute the same bits as in the master's process, and cannot crash it.
#include "fmi/unpack_folder.hpp"
#include "slave/isolation/guard.hpp"
#include "support/sanitizer.hpp"
#include "test_system.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/file.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <csignal>
#include <thread>

namespace mebots::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// A system with buffers, texts, two step sizes, and connections of all types.
constexpr const char* kIsolatedSystem = R"({"step": 0.01, "stop_time": 1, "instances": {
    "a": {"fmu": "PROBE", "parameters": {"gain": -0.9, "offset": 0.3, "string_in": "a, b"}},
    "b": {"fmu": "PROBE", "parameters": {"gain": 0.8}, "step": 0.02}},
  "connections": [{"from": "a.real_out", "to": "b.real_in"}, {"from": "b.real_out", "to": "a.real_in"},
                  {"from": "a.buffer", "to": "b.taken"}, {"from": "a.steps", "to": "b.integer_in"},
                  {"from": "a.string_out", "to": "b.string_in"}, {"from": "a.boolean_out", "to": "b.boolean_in"}],
  "record": {"texts": true}})";

/// True if Landlock blocks signals from a sandbox to other processes (since Linux 6.12).
bool kernel_keeps_signals_inside() {
  constexpr long kCreateRuleset = 444;
  constexpr int kAskVersion = 1;
  return syscall(kCreateRuleset, nullptr, 0, kAskVersion) >= 6;
}

class Isolation : public testing::Test {
 protected:
  Isolation() {
    write_file(folder.path() / "two.json", with_probe(kIsolatedSystem));
    setenv("TMPDIR", folder.path().c_str(), 1);
  }
  ~Isolation() override { unsetenv("TMPDIR"); }

  ProgramResult run(std::vector<std::string> more) const {
    more.insert(more.begin(), {"run", "two.json"});
    return run_program(more, folder.path());
  }
  std::string result(const std::string& file) const { return read_file(folder.path() / "results" / "two" / file); }
  nlohmann::json summary() const { return nlohmann::json::parse(result("summary.json")); }
  void give_b(const std::string& keys) {
    std::string text = kIsolatedSystem;
    text.insert(text.find(R"("step": 0.02)"), keys + ", ");
    write_file(folder.path() / "two.json", with_probe(text));
  }
  /// Returns the processes of this test. Their environment, or the command line of a sandboxed process, contains the
  /// folder of the test.
  std::vector<pid_t> processes_left() const {
    std::vector<pid_t> found;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
      const auto name = entry.path().filename().string();
      if (name.find_first_not_of("0123456789") != std::string::npos) continue;
      const auto number = static_cast<pid_t>(std::stol(name));
      if (number != getpid() && is_marked(entry.path())) {
        found.push_back(number);
      }
    }
    return found;
  }
  /// True if all these processes end within ten seconds. A killed process may take some time to end.
  bool all_end() const {
    for (int i = 0; i < 500 && !processes_left().empty(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return processes_left().empty();
  }
  bool is_marked(const std::filesystem::path& process) const {
    return read_file(process / "environ").find("MEBOTS_TEST=" + folder.path().string()) != std::string::npos ||
           read_file(process / "cmdline").find(folder.path().string() + "/mebots") != std::string::npos;
  }

  modeldesc::TemporaryFolder folder{"mebots-test"};
};

/// Runs `mebots run two.json --isolate` with the option `limit` of ulimit. Returns the exit code and the text on
/// stderr.
ProgramResult run_below(const std::string& limit, const std::filesystem::path& folder) {
  const auto command = fmt::format("cd '{0}' && {{ ulimit {1} && '{2}' run two.json --isolate --quiet; }} 2>'{0}/err'",
                                   folder.string(), limit, MEBOTS_PROGRAM);
  const int status = std::system(command.c_str());  // NOLINT(concurrency-mt-unsafe): no other thread is there
  return {WEXITSTATUS(status), "", read_file(folder / "err")};
}

TEST_F(Isolation, NeedsTwoDescriptorsForEachInstance) {
  std::string instances;
  for (int i = 0; i < 100; ++i)
    instances += fmt::format(R"({}"i{}": {{"fmu": "{}"}})", i == 0 ? "" : ", ", i, PASSTHROUGH_FMU);
  write_file(folder.path() / "two.json",
             fmt::format(R"({{"step": 1, "stop_time": 1, "instances": {{{}}}, "connections": []}})", instances));
  EXPECT_EQ(run_below("-n 250", folder.path()).code, 0);
  EXPECT_EQ(run_below("-Sn 64", folder.path()).code, 0) << "the limit can be raised";
  const auto refused = run_below("-n 200", folder.path());
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err,
              testing::ContainsRegex("100 isolated instances need 2[34][0-9] open files .* hard limit is 200"));
  EXPECT_THAT(refused.err, Not(HasSubstr("Too many open files")));
}

TEST_F(Isolation, OwnProcessesGiveTheSameBits) {
  ASSERT_EQ(run({}).code, 0);
  const auto csv = result("results.csv");
  const auto log = result("log.txt");
  const auto isolated = run({"--isolate"});
  EXPECT_EQ(isolated.code, 0) << isolated.err;
  EXPECT_TRUE(result("results.csv") == csv);
  const auto lines = [](const std::string& text) {  // only the messages of each instance are in order
    std::istringstream stream(text);
    std::map<std::string, std::string> by_instance;
    for (std::string line; std::getline(stream, line);) by_instance[line.substr(14, 1)] += line + "\n";
    return by_instance;
  };
  EXPECT_EQ(lines(result("log.txt")), lines(log));
}

TEST_F(Isolation, TimeDerivativesTravelAsInTheMastersProcess) {
  const auto config = [](const std::string& process) {
    return fmt::format(R"({{"step": 0.1, "stop_time": 2, "instances": {{
      "a": {{"fmu": "COUPLING", "parameters": {{"mass_x": 1}}, "process": "{0}"}}, "b": {{"fmu": "COUPLING", "process": "{0}"}}}},
      "connections": [{{"from": "a.mass_x", "to": "b.mass_u"}}, {{"from": "b.mass_x", "to": "a.mass_u"}},
                      {{"from": "a.ramp_out", "to": "b.ramp_in"}}]}})",
                       process);
  };
  TestRun shared(config("shared"));
  TestRun own(config("own"));
  shared.to_end();
  own.to_end();
  EXPECT_GT(shared.column("b.ramp_area").back(), 2.6) << "8/3 with derivatives, 2.47 where the input is held";
  EXPECT_EQ(own.csv(), shared.csv());
}

TEST_F(Isolation, StatesGoAlongWithTheProcess) {
  TestRun straight(kIsolatedSystem);
  straight.to_end();
  std::string config = kIsolatedSystem;
  for (const auto* fmu :
       {R"("fmu": "PROBE", "parameters": {"gain": -0.9)", R"("fmu": "PROBE", "parameters": {"gain": 0.8})"})
    config.insert(config.find(fmu), R"("process": "own", )");
  std::vector<std::byte> bytes;
  {
    TestRun first(config);
    first.initialize();
    for (int i = 0; i < 51; ++i) first.simulation().step();
    const auto state = first.simulation().save_state();
    for (int i = 0; i < 20; ++i) first.simulation().step();
    first.simulation().restore_state(state);
    bytes = first.simulation().serialize(state);
    while (first.simulation().step()) {
    }
    EXPECT_EQ(first.csv(), straight.csv());
  }
  TestRun second(config);
  second.initialize();
  const auto state = second.simulation().deserialize(bytes);
  for (int i = 0; i < 70; ++i) second.simulation().step();
  second.simulation().restore_state(state);
  while (second.simulation().step()) {
  }
  EXPECT_EQ(second.csv(), straight.csv());
}

struct Fault {
  const char* name;
  const char* message;
};
void PrintTo(const Fault& fault, std::ostream* out) {
  *out << fault.message;
}

class IsolationFault : public Isolation, public testing::WithParamInterface<Fault> {
 protected:
  void SetUp() override {
    if (GetParam().name == std::string_view("kill_group") && !kernel_keeps_signals_inside())
      GTEST_SKIP() << "a process signals itself alone there";
    if (kSanitizerTakesCrashesAndMemory && GetParam().name == std::string_view("memory")) {
      GTEST_SKIP() << "the limit is one of address space (RLIMIT_AS), of which the sanitizer's allocator has taken its "
                      "terabytes before: what the FMU allocates is no more";
    }
  }
};

TEST_P(IsolationFault, EndsTheRunWithItsReasonAndTheResultsSoFar) {
  const auto [name, message] = GetParam();
  give_b(R"("memory_limit_mb": 200, "deadline": 2)");
  const auto run_result = run({"--set", fmt::format("b.fault={}", name), "--set", "b.fault_time=0.5"});
  EXPECT_EQ(run_result.code, 1);
  EXPECT_THAT(run_result.err, AllOf(HasSubstr("instance 'b' at 0.48 s"), HasSubstr(message), HasSubstr("fmi2DoStep")));
  EXPECT_THAT(result("results.csv"), AllOf(HasSubstr("\n0.48,"), Not(HasSubstr("\n0.49,"))));
  EXPECT_EQ(result("results.csv").back(), '\n');
  EXPECT_EQ(summary()["outcome"], "failed");
  EXPECT_THAT(summary()["error"].get<std::string>(), HasSubstr(message));
  EXPECT_EQ(summary()["error_code"], std::string_view(name) == "hang" ? "fmu_timeout" : "fmu_lost");
}

TEST_P(IsolationFault, LeavesTheOthersGoingOnWhereTheConfigAllows) {
  const auto [name, message] = GetParam();
  give_b(R"("memory_limit_mb": 200, "deadline": 2, "on_failure": "continue")");
  const auto run_result = run({"--set", fmt::format("b.fault={}", name), "--set", "b.fault_time=0.5"});
  EXPECT_EQ(run_result.code, 0) << run_result.err;
  EXPECT_THAT(run_result.err, AllOf(HasSubstr(message), HasSubstr("'b' was lost at 0.48 s")));
  const auto json = summary();
  EXPECT_EQ(json["simulated_time"], 1.0);
  EXPECT_EQ(json["lost_instances"]["b"]["at"], 0.48);
  EXPECT_THAT(json["lost_instances"]["b"]["error"].get<std::string>(), HasSubstr(message));
}

INSTANTIATE_TEST_SUITE_P(
    Each, IsolationFault,
    testing::Values(Fault{"crash", "signal 11 (SIGSEGV"}, Fault{"null", "signal 11 (SIGSEGV, invalid memory access)"},
                    Fault{"bus", "signal 7 (SIGBUS"}, Fault{"division", "signal 8 (SIGFPE"},
                    Fault{"illegal", "signal 4 (SIGILL"}, Fault{"abort", "signal 6 (SIGABRT, abort)"},
                    Fault{"exit", "ended itself with exit code 3"}, Fault{"hang", "within its deadline of 2 s"},
                    Fault{"stack", "its stack overflowed"}, Fault{"memory", "memory_limit_mb allows 200"},
                    Fault{"kill_group", "signal 9 (SIGKILL"}),
    [](const auto& fault) { return std::string(fault.param.name); });

TEST_F(Isolation, AnFmuThatClosesAllFilesOrKillsItsParentHarmsNoOther) {
  ASSERT_EQ(run({}).code, 0);
  const auto csv = result("results.csv");
  for (const std::string fault : {"close", "kill_parent"}) {
    give_b(R"("process": "own")");
    const auto run_result = run({"--set", "b.fault=" + fault, "--set", "b.fault_time=0.5"});
    EXPECT_EQ(run_result.code, 0) << fault << run_result.err;
    EXPECT_EQ(result("results.csv"), csv);
  }
}

/// Another process of the same user during the lifetime of this object.
class Bystander {
 public:
  Bystander() {
    if (process_ == 0) {
      while (true) pause();
    }
    setenv("MEBOTS_TEST_BYSTANDER", std::to_string(process_).c_str(), 1);
  }
  ~Bystander() {
    unsetenv("MEBOTS_TEST_BYSTANDER");
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  Bystander(const Bystander&) = delete;
  Bystander& operator=(const Bystander&) = delete;
  pid_t process() const { return process_; }
  bool lives() const { return waitpid(process_, nullptr, WNOHANG) == 0; }

 private:
  pid_t process_ = fork();
};

TEST_F(Isolation, AnFmuChangesNoOtherProcess) {
  const Bystander bystander;
  const auto others = run({"--isolate", "--set", "b.fault=harm_others", "--set", "b.fault_time=0.5"});
  EXPECT_EQ(others.code, 0) << others.err;
  EXPECT_TRUE(bystander.lives());
  const auto foreign = run({"--isolate", "--set", "b.fault=foreign_call", "--set", "b.fault_time=0.5"});
  EXPECT_EQ(foreign.code, 1);
  EXPECT_THAT(foreign.err, AllOf(HasSubstr("instance 'b'"), HasSubstr("signal 31 (SIGSYS"), HasSubstr("fmi2DoStep")));
}

TEST_F(Isolation, AnFmuEndsItsOwnHelpers) {
  if (!kernel_keeps_signals_inside()) GTEST_SKIP() << "by the arguments of a call nobody knows a child";
  const auto result = run({"--isolate", "--set", "b.fault=end_child", "--set", "b.fault_time=0.5"});
  EXPECT_EQ(result.code, 0) << result.err;
}

TEST(Guard, AllowsSignalsToItselfOnlyWithoutLandlock) {
  const Bystander bystander;
  const auto other = bystander.process();
  const auto tried = fork();
  if (tried == 0) {
    master::isolation::forbid_harm(master::isolation::Signals::to_itself);
    const auto refused = [](long answer) { return answer == -1 && errno == EPERM; };
    const long high = static_cast<long>(other) | (1L << 32);  // the kernel uses only the low 32 bits
    bool held = refused(kill(other, SIGKILL)) && refused(syscall(SYS_kill, high, SIGKILL)) &&
                refused(kill(-1, SIGKILL)) && refused(kill(0, SIGKILL)) &&
                refused(syscall(SYS_tkill, other, SIGKILL)) && refused(syscall(SYS_tgkill, other, other, SIGKILL)) &&
                refused(syscall(SYS_pidfd_open, other, 0));
    held = held && kill(getpid(), 0) == 0 && raise(SIGURG) == 0;
    _exit(held ? 0 : 1);
  }
  int status = 0;
  waitpid(tried, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  EXPECT_TRUE(bystander.lives());
}

/// Tests that the master does not trust data that an FMU writes into shared memory.
class Forgery : public Isolation, public testing::WithParamInterface<Fault> {};

TEST_P(Forgery, EndsTheRunWithItsCulprit) {
  const auto [name, message] = GetParam();
  give_b(R"("memory_limit_mb": 200, "deadline": 1)");
  const auto began = std::chrono::steady_clock::now();
  const auto run_result = run({"--set", fmt::format("b.fault={}", name), "--set", "b.fault_time=0.5"});
  EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(60)) << "calls end by the master's clock";
  EXPECT_EQ(run_result.code, 1);
  EXPECT_THAT(run_result.err, AllOf(HasSubstr("instance 'b' at 0.48 s"), HasSubstr(message)));
  EXPECT_THAT(result("results.csv"), AllOf(HasSubstr("\n0.48,"), Not(HasSubstr("\n0.49,"))));
  EXPECT_EQ(summary()["outcome"], "failed");
}

INSTANTIATE_TEST_SUITE_P(Each, Forgery,
                         testing::Values(Fault{"forge_log", "it claims 1099511627776 bytes of messages"},
                                         Fault{"forge_length", "an answer of 1099511627776 bytes"},
                                         Fault{"forge_answer",
                                               "the shared memory between master and FMU process is damaged"},
                                         Fault{"forge_calls", "within its deadline of 1 s"}),
                         [](const auto& fault) { return std::string(fault.param.name); });

TEST_F(Isolation, KeepsTheResultsIfFreeingAnInstanceFails) {
  give_b(R"("process": "own")");
  ASSERT_EQ(run({}).code, 0);
  const auto csv = result("results.csv");
  for (const auto& [fault, message] :
       {std::pair("free_crash", "was ended by signal 11 (SIGSEGV, invalid memory access) in fmi2FreeInstance"),
        {"free_hang", "fmi2FreeInstance did not return within 3 s"},
        {"free_exit", "ended itself with exit code 0 in fmi2FreeInstance"},
        {"destructor", "in the destructors of its library"}}) {
    const auto run_result = run({"--set", fmt::format("b.fault={}", fault), "--set", "b.fault_time=9"});
    EXPECT_EQ(run_result.code, 1) << fault;
    EXPECT_THAT(run_result.err, AllOf(HasSubstr("b: error:"), HasSubstr(message))) << fault;
    EXPECT_TRUE(result("results.csv") == csv) << fault;
    EXPECT_EQ(summary()["outcome"], "completed");
    EXPECT_THAT(summary()["notices"].dump(),
                AllOf(HasSubstr("error after the end of the run: instance 'b'"), HasSubstr(message)));
    EXPECT_THAT(result("log.txt"), HasSubstr(message));
  }
  give_b(R"("process": "own", "on_failure": "continue")");
  EXPECT_EQ(run({"--set", "b.fault=free_crash", "--set", "b.fault_time=9"}).code, 0) << "its failures are expected";
}

TEST_F(Isolation, AStateOfImpossibleSizeNamesItsFmu) {
  for (const auto* process : {R"("process": "own")", R"("process": "shared")"}) {
    give_b(process);
    const auto run_result =
        run({"--checkpoint-every", "0.5", "--set", "b.fault=huge_state", "--set", "b.fault_time=9"});
    EXPECT_EQ(run_result.code, 1) << process;
    EXPECT_THAT(run_result.err, AllOf(HasSubstr("instance 'b'"), HasSubstr("fmi2SerializedFMUstateSize"),
                                      HasSubstr("35184372088832 bytes")));
  }
}

class Sandbox : public Isolation {
 protected:
  void SetUp() override {
    if (!sandbox_refusal().empty()) GTEST_SKIP() << sandbox_refusal();
  }
  ProgramResult run_shut_in(const std::vector<std::string>& more) {
    give_b(R"("process": "sandboxed")");
    return run(more);
  }
};

TEST_F(Sandbox, GivesTheSameBits) {
  ASSERT_EQ(run({}).code, 0);
  const auto csv = result("results.csv");
  const auto shut_in = run_shut_in({});
  EXPECT_EQ(shut_in.code, 0) << shut_in.err;
  EXPECT_TRUE(result("results.csv") == csv);
}

TEST_F(Sandbox, RefusesToRunWithoutBubblewrapUnlessTheConfigAllowsIt) {
  setenv("MEBOTS_BUBBLEWRAP", "/nonexistent/bwrap", 1);
  give_b(R"("process": "sandboxed")");
  const auto refused = run({});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.err,
              AllOf(HasSubstr("instance 'b'"), HasSubstr("namespaces (the program /nonexistent/bwrap was not found"),
                    HasSubstr("may_lack")));
  give_b(R"("process": "sandboxed", "sandbox": {"may_lack": ["namespaces"]})");
  const auto allowed = run({});
  unsetenv("MEBOTS_BUBBLEWRAP");
  EXPECT_EQ(allowed.code, 0) << allowed.err;
  EXPECT_THAT(allowed.err, HasSubstr("the sandbox lacks namespaces"));
  EXPECT_THAT(result("summary.json"), HasSubstr("the sandbox lacks namespaces"));
}

TEST_F(Sandbox, MayReadWhatTheConfigLists) {
  write_file(folder.path() / "table.txt", "42");
  for (const auto& [keys, is_readable] : {std::pair("", false), {R"(, "sandbox": {"reads": ["table.txt"]})", true}}) {
    give_b(fmt::format(R"("process": "sandboxed"{})", keys));
    const auto run_result = run({"--set", "b.fault_time=0.5", "--set",
                                 fmt::format("b.fault=read_file {}", (folder.path() / "table.txt").string())});
    EXPECT_EQ(run_result.code, is_readable ? 0 : 1) << run_result.err;
  }
}

TEST_F(Sandbox, EndsAsItsFmuEndsAndTakesEverythingWithIt) {
  setenv("MEBOTS_TEST", folder.path().c_str(), 1);
  for (const auto& [fault, message] : {std::pair("null", "signal 11 (SIGSEGV, invalid memory access)"),
                                       {"abort", "signal 6 (SIGABRT, abort)"},
                                       {"exit", "ended itself with exit code 3"},
                                       {"kill_group", "signal 9 (SIGKILL"}}) {
    if (std::string_view(fault) == "kill_group" && !kernel_keeps_signals_inside()) continue;
    const auto run_result = run_shut_in({"--set", fmt::format("b.fault={}", fault), "--set", "b.fault_time=0.5"});
    EXPECT_EQ(run_result.code, 1);
    EXPECT_THAT(run_result.err, AllOf(HasSubstr("instance 'b' at 0.48 s"), HasSubstr(message))) << fault;
  }
  EXPECT_EQ(run_shut_in({"--set", "b.fault=orphan", "--set", "b.fault_time=0.9"}).code, 0);
  EXPECT_TRUE(all_end());
  unsetenv("MEBOTS_TEST");
}

TEST_F(Isolation, EndsProcessesOfAnFmuWithTheRun) {
  setenv("MEBOTS_TEST", folder.path().c_str(), 1);
  give_b(R"("process": "own")");
  EXPECT_EQ(run({"--set", "b.fault=orphan", "--set", "b.fault_time=0.9"}).code, 0);
  EXPECT_TRUE(all_end());
  unsetenv("MEBOTS_TEST");
}

TEST_F(Isolation, ADaemonThatAnFmuLeavesGoesWithTheRun) {
  if (!sandbox_refusal().empty()) GTEST_SKIP() << sandbox_refusal();
  setenv("MEBOTS_TEST", folder.path().c_str(), 1);
  for (const auto* const process : {"own", "sandboxed"}) {
    give_b(fmt::format(R"("process": "{}", "deadline": 0.5)", process));
    EXPECT_EQ(run({"--set", "b.fault=daemon", "--set", "b.fault_time=0.5"}).code, 1);
    EXPECT_TRUE(processes_left().empty()) << process;
  }
  unsetenv("MEBOTS_TEST");
}

TEST_F(Isolation, HalfALibraryEndsTheRunBeforeItBegins) {
  const auto binary = read_file(PROBE_LIBRARY);
  for (const double part : {0.1, 0.5}) {
    write_file(folder.path() / "half.so",
               binary.substr(0, static_cast<std::size_t>(part * static_cast<double>(binary.size()))));
    modeldesc::pack(folder.path() / "half.fmu", {{"modelDescription.xml", PROBE_DESCRIPTION},
                                                 {"binaries/linux64/probe.so", folder.path() / "half.so"}});
    write_file(folder.path() / "two.json", R"({"step": 0.1, "stop_time": 1, "connections": [],
      "instances": {"a": {"fmu": "half.fmu", "process": "own"}}})");
    const auto run_result = run({});
    EXPECT_EQ(run_result.code, 2) << part << run_result.err;
    EXPECT_THAT(run_result.err, HasSubstr("a"));
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "results"));
  }
}

TEST_F(Isolation, AKilledMasterLeavesNoProcessAndTheNextOneCleansUp) {
  setenv("MEBOTS_TEST", folder.path().c_str(), 1);
  const auto temporary = folder.path() / "tmp";
  std::filesystem::create_directory(temporary);
  setenv("TMPDIR", temporary.c_str(), 1);
  give_b(R"("process": "own")");
  const auto child = fork();
  if (child == 0) {
    if (chdir(folder.path().c_str()) != 0) _exit(99);
    execl(MEBOTS_PROGRAM, MEBOTS_PROGRAM, "run", "two.json", "--quiet", "--set", "b.fault=daemon", "--set",
          "b.fault_time=0.1", nullptr);
    _exit(98);
  }
  constexpr std::size_t kAll = 4;  // the program, the keeper, the FMU's process, and the daemon
  int stable = 0;                  // consecutive equal counts: an ending process is still listed for a short time
  for (int i = 0; i < 3000 && stable < 10; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    stable = processes_left().size() == kAll ? stable + 1 : 0;
  }
  EXPECT_EQ(stable, 10) << processes_left().size() << " processes";
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(all_end());
  EXPECT_FALSE(std::filesystem::is_empty(temporary));
  // The environment of an ending process disappears before its files are closed, which releases its locks.
  for (const auto& entry : std::filesystem::directory_iterator(temporary)) {
    const int owner = open((entry.path() / "owner").c_str(), O_RDWR | O_CLOEXEC);
    if (owner < 0) continue;
    EXPECT_EQ(flock(owner, LOCK_EX), 0);
    close(owner);
  }
  EXPECT_EQ(run({"--quiet"}).code, 0);
  EXPECT_TRUE(std::filesystem::is_empty(temporary));
  unsetenv("TMPDIR");
  unsetenv("MEBOTS_TEST");
}

TEST_F(Isolation, AnInterruptEndsAnFmuThatHangs) {
  give_b(R"("process": "own")");
  const auto child = fork();
  if (child == 0) {
    if (chdir(folder.path().c_str()) != 0) _exit(99);
    execl(MEBOTS_PROGRAM, MEBOTS_PROGRAM, "run", "two.json", "--quiet", "--set", "b.fault=hang", "--set",
          "b.fault_time=0.5", nullptr);
    _exit(98);
  }
  while (!std::filesystem::exists(folder.path() / "results/two/results.csv")) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_EQ(summary()["outcome"], "interrupted");
  EXPECT_THAT(summary()["end_text"].get<std::string>(), AllOf(HasSubstr("'b'"), HasSubstr("after the interrupt")));
}

TEST_F(Isolation, ADeadlineNeedsAnOwnProcess) {
  give_b(R"("process": "shared", "deadline": 1)");
  const auto run_result = run({});
  EXPECT_EQ(run_result.code, 2);
  EXPECT_THAT(run_result.err, AllOf(HasSubstr("/instances/b/deadline"), HasSubstr("\"process\": \"own\"")));
}

}  // namespace
}  // namespace mebots::test
