// SPDX-License-Identifier: Apache-2.0
// Tests many instances of an FMU, at the same time and one after the other. scripts/scale.sh runs the full version.
#include "slave/fmi/fmi2_slave.hpp"
#include "support/sanitizer.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

namespace mebots::test {
namespace {

using master::Fmi2Slave;
using master::Fmu;

struct Holdings {
  std::size_t files;
  std::size_t mappings;
  std::size_t heap_bytes;
};

Holdings holdings() {
  Holdings now{};
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) ++now.files;
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) ++now.mappings;
  const auto info = mallinfo2();
  now.heap_bytes = info.uordblks + info.hblkhd;
  return now;
}

/// Prints measurements for scripts/scale.sh.
void report(const char* what, int count, const Holdings& before, const Holdings& after) {
  fmt::print("{} {}: files {} -> {}, mappings {} -> {}, heap {} -> {} bytes\n", count, what, before.files, after.files,
             before.mappings, after.mappings, before.heap_bytes, after.heap_bytes);
}

/// Returns the FMU to load repeatedly: the FMU in MEBOTS_CYCLED_FMU, otherwise the cheapest FMU.
std::filesystem::path cycled_fmu() {
  const char* asked = std::getenv("MEBOTS_CYCLED_FMU");  // NOLINT(concurrency-mt-unsafe): before any thread
  return asked == nullptr ? PASSTHROUGH_FMU : asked;
}

int cycles() {
  const char* asked = std::getenv("MEBOTS_CYCLES");  // NOLINT(concurrency-mt-unsafe): before any thread
  return asked == nullptr ? 1000 : std::atoi(asked);
}

TEST(Scale, AThousandInstancesOfOneFmuRunAsARing) {
  constexpr int kCount = 1000;
  std::string instances;
  std::string connections;
  for (int i = 0; i < kCount; ++i) {
    instances += fmt::format(R"({}"i{}": {{"fmu": "{}"{}}})", i == 0 ? "" : ", ", i, PASSTHROUGH_FMU,
                             i == 0 ? R"(, "parameters": {"u": 1})" : "");
    if (i > 0) connections += fmt::format(R"({}{{"from": "i{}.y", "to": "i{}.u"}})", i == 1 ? "" : ", ", i - 1, i);
  }
  TestRun run(
      fmt::format(R"({{"step": 1, "stop_time": {}, "record": ["i{}.y"], "instances": {{{}}}, "connections": [{}]}})",
                  kCount + 10, kCount - 1, instances, connections));
  const auto last = run.to_end().column(fmt::format("i{}.y", kCount - 1));
  // In each step, the first value reaches the next instance, so the last of kCount outputs changes after kCount steps.
  EXPECT_EQ(last[kCount - 1], 0);
  EXPECT_EQ(last[kCount], 1);
}

std::string ring(int count) {
  std::string instances;
  std::string connections;
  for (int i = 0; i < count; ++i) {
    instances += fmt::format(R"({}"i{}": {{"fmu": "{}"}})", i == 0 ? "" : ", ", i, PASSTHROUGH_FMU);
    connections += fmt::format(R"({}{{"from": "i{}.y", "to": "i{}.u"}})", i == 0 ? "" : ", ", i, (i + 1) % count);
  }
  return fmt::format(R"({{"step": 1, "stop_time": 2, "record": ["i0.y"], "instances": {{{}}}, "connections": [{}]}})",
                     instances, connections);
}

/// Returns the processor time of ended child processes in seconds.
double childrens_processor_s() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
}

TEST(Scale, AWholeRunTakesTimeInProportionToItsInstancesAndConnections) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  const auto seconds_of = [&](int count) {
    write_file(folder.path() / "ring.json", ring(count));
    const double before = childrens_processor_s();
    EXPECT_EQ(run_program({"run", "ring.json", "--quiet"}, folder.path()).code, 0);
    return childrens_processor_s() - before;
  };
  constexpr int kFew = 2500;
  constexpr int kTimes = 8;
  const double few = std::max({seconds_of(kFew), seconds_of(kFew), seconds_of(kFew)});
  // For eight times the instances, the time is about 7 times as long. If each connection searched all instances one by
  // one, it would be 43 times as long.
  EXPECT_LT(seconds_of(kTimes * kFew), 2.5 * kTimes * few);
}

TEST(Scale, ReadingALargeConfigIsInterrupted) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  write_file(folder.path() / "ring.json", ring(100'000));
  const auto reader = fork();
  if (reader == 0) {
    const auto file = folder.path() / "ring.json";
    execl(MEBOTS_PROGRAM, MEBOTS_PROGRAM, "run", file.c_str(), "--out", (folder.path() / "out").c_str(), "--quiet",
          nullptr);
    _exit(98);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  kill(reader, SIGINT);
  const double before = childrens_processor_s();
  int status = 0;
  waitpid(reader, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 1);
  EXPECT_LT(childrens_processor_s() - before, 2.0) << "all of it would take longer";
}

TEST(Scale, InstancesReleaseAllResources) {
  if (kSanitizerTakesCrashesAndMemory) GTEST_SKIP() << "heap and mappings are the sanitizer's own";
  const auto fmu = std::make_shared<Fmu>(cycled_fmu());
  Messages messages;
  const auto start = [&](const char* name) {
    auto slave = std::make_unique<Fmi2Slave>(name, fmu, std::vector<std::string>{}, messages);
    slave->setup_experiment({});
    slave->enter_initialization();
    slave->exit_initialization();
    slave->step(0, 2'000'000);
    return slave;
  };
  const auto cycle = [&] { start("cycle")->terminate(); };
  const auto stays = start("stays");                // keeps the data that the FMU's instances share
  for (int i = 0; i < cycles() / 10; ++i) cycle();  // performs allocations that occur only once
  const auto before = holdings();
  for (int i = 0; i < cycles(); ++i) cycle();
  const auto after = holdings();
  report("instances one after the other", cycles(), before, after);
  EXPECT_EQ(after.files, before.files);
  EXPECT_LE(after.mappings, before.mappings);
  EXPECT_LE(after.heap_bytes, before.heap_bytes + 1024) << "a byte per instance would show";
}

TEST(Scale, ClosedArchivesReleaseAllResources) {
  if (kSanitizerTakesCrashesAndMemory) GTEST_SKIP() << "heap and mappings are the sanitizer's own";
  const auto open = [] { Fmu(cycled_fmu()).require_library(); };
  for (int i = 0; i < 5; ++i) open();
  const auto before = holdings();
  const int count = cycles() / 20;
  for (int i = 0; i < count; ++i) open();
  const auto after = holdings();
  report("archives opened and closed", count, before, after);
  EXPECT_EQ(after.files, before.files);
  EXPECT_LE(after.mappings, before.mappings + 2) << "the heap may grow by itself";
  constexpr std::size_t kLargest = 100;  // bytes per opening, which the loader keeps for each library
  EXPECT_LE(after.heap_bytes, before.heap_bytes + kLargest * static_cast<std::size_t>(count));
}

TEST(Scale, EndedProcessesReleaseAllResources) {
  const auto whole_run = [] {
    TestRun run(fmt::format(
        R"({{"step": 1, "stop_time": 2, "instances": {{"a": {{"fmu": "{}", "process": "own"}}}}, "connections": []}})",
        PASSTHROUGH_FMU));
    run.to_end();
  };
  for (int i = 0; i < 3; ++i) whole_run();
  const auto before = holdings();
  for (int i = 0; i < cycles() / 50; ++i) whole_run();
  const auto after = holdings();
  report("runs in a process of their own", cycles() / 50, before, after);
  EXPECT_EQ(after.files, before.files);
  EXPECT_LE(after.mappings, before.mappings + 2) << "the heap may grow by itself";
  EXPECT_LE(after.heap_bytes, before.heap_bytes + 4096) << "a hundred bytes per run would show";
}

}  // namespace
}  // namespace mebots::test
