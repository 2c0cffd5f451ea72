// SPDX-License-Identifier: Apache-2.0
#include "engine/algorithm/thread_policy.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <atomic>
#include <vector>

namespace mebots::test {
namespace {

using master::StepPool;
using master::ThreadPolicy;

TEST(StepPool, DoesEveryPieceOfWorkOnce) {
  StepPool pool(3);
  for (std::size_t count : {0U, 1U, 2U, 7U, 100U}) {
    std::vector<std::atomic<int>> done(count);
    for (int round = 0; round < 50; ++round) pool.run(count, [&](std::size_t i) { ++done[i]; });
    for (const auto& times : done) EXPECT_EQ(times.load(), 50);
  }
}

TEST(ThreadPolicy, ShortStepsAreNeverTriedInParallel) {
  ThreadPolicy policy;
  for (int window = 0; window < 10'000; ++window) {
    EXPECT_FALSE(policy.parallel());
    policy.window_took(0.9 * ThreadPolicy::kWindow * ThreadPolicy::kLeastStep_s);
  }
}

/// A window is a number of steps after which the policy can change between one thread and parallel stepping. Returns
/// how many of 10000 windows are parallel. `serial_s` and `parallel_s` are the durations of a window in seconds.
int parallel_windows(double serial_s, double parallel_s) {
  ThreadPolicy policy;
  int parallel = 0;
  for (int window = 0; window < 10'000; ++window) {
    parallel += policy.parallel() ? 1 : 0;
    policy.window_took(policy.parallel() ? parallel_s : serial_s);
  }
  return parallel;
}

TEST(ThreadPolicy, KeepsTheFasterSetting) {
  EXPECT_GT(parallel_windows(10e-3, 5e-3), 9600) << "2 windows of 66 are for comparing";
  EXPECT_LT(parallel_windows(10e-3, 11e-3), 20);
  EXPECT_LT(parallel_windows(10e-3, 9.9e-3), 20) << "what is within the noise stays serial";
}

TEST(ThreadPolicy, FollowsWhenTheCostsChange) {
  ThreadPolicy policy;
  const auto windows = [&](int count, double serial_s, double parallel_s) {
    for (int i = 0; i < count; ++i) policy.window_took(policy.parallel() ? parallel_s : serial_s);
    return policy.parallel();
  };
  EXPECT_TRUE(windows(10, 10e-3, 5e-3));
  EXPECT_FALSE(windows(100, 10e-3, 20e-3));
  EXPECT_TRUE(windows(100, 10e-3, 5e-3));
}

TEST(ThreadPolicy, CheapStepsAfterDearOnesAreNotTakenForAGain) {
  // In this mission, threads are useful only while a network computes.
  ThreadPolicy policy;
  double serial_s = 0;
  double taken_s = 0;
  for (int window = 0; window < 10'000; ++window) {
    const bool dear = window % 50 < 5;
    const double alone_s = dear ? 10e-3 : 1e-3;
    const double together_s = dear ? 8e-3 : 2e-3;
    const double took_s = policy.parallel() ? together_s : alone_s;
    serial_s += alone_s;
    taken_s += took_s;
    policy.window_took(took_s);
  }
  EXPECT_LT(taken_s, 1.003 * serial_s) << "1.0095 when only the last serial run counted";
}

/// Returns a config of a ring of four instances whose steps are long enough for threads. 60 steps are at least three
/// windows.
std::string ring(const std::string& threads) {
  const auto instance = [](const char* name, const char* more) {
    return fmt::format(R"("{}": {{"fmu": "{}", "parameters": {{"sum": 0.1, "work": 30000}}{}}})", name, PASSTHROUGH_FMU,
                       more);
  };
  return fmt::format(R"({{
    "step": 0.1, "stop_time": 6, "threads": {},
    "instances": {{{}, {}, {}, {}}},
    "connections": [{{"from": "a.sum", "to": "b.u"}}, {{"from": "b.sum", "to": "c.u"}},
                    {{"from": "c.sum", "to": "d.u"}}, {{"from": "d.y", "to": "a.u"}}]
  }})",
                     threads, instance("a", ""), instance("b", ""), instance("c", R"(, "step": 0.2)"),
                     instance("d", ""));
}

TEST(Threads, GiveTheSameBitsAsNone) {
  const auto alone = TestRun(ring("1")).to_end().csv();
  EXPECT_THAT(alone, testing::HasSubstr("6,"));
  EXPECT_EQ(TestRun(ring("2")).to_end().csv(), alone);
  EXPECT_EQ(TestRun(ring("4")).to_end().csv(), alone);
  EXPECT_EQ(TestRun(ring("\"auto\"")).to_end().csv(), alone);
}

TEST(Threads, AreAutoOrANumber) {
  EXPECT_THAT(input_error([] { TestRun run(ring("0")); }), testing::HasSubstr("from 1 to 256"));
  EXPECT_THAT(input_error([] { TestRun run(ring("\"many\"")); }), testing::HasSubstr("'auto'"));
  EXPECT_THAT(input_error([] { TestRun run(ring("1.5")); }), testing::HasSubstr("from 1 to 256"));
}

}  // namespace
}  // namespace mebots::test
