// SPDX-License-Identifier: Apache-2.0
// Tests GAP8's frequency-locked loops while the cluster is running: time, energy and bits after a core changes the
// clock.
#include "gap8_system.hpp"
#include "support/same_state.hpp"

#include "mebots/state/save.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mebots::soc::test {
namespace {

enum class Meanwhile : std::uint8_t { sleeps, spins };
struct Others {
  Meanwhile controller = Meanwhile::sleeps;
  std::uint32_t cores = 0;
  Meanwhile of_cores = Meanwhile::sleeps;
};

/// Returns a program whose core 0 loops 200,000 times, executes `change`, and loops again. Then it stores into tohost.
std::string core_that_changes(std::string_view change, const Others& others) {
  return fmt::format(R"({}{}
2:  {}
    j 2b
core: bnez a0, 6f
    li t0, 200000
3:  addi t0, t0, -1
    bnez t0, 3b
    {}
    li t0, 200000
4:  addi t0, t0, -1
    bnez t0, 4b
    la t0, tohost
    li t1, 1
    sw t1, 0(t0)
5:  j 5b
6:  li s0, EU_BASE
7:  {}
    j 7b
fault: j fault
    .section .tohost, "aw", @progbits
    .balign 64
    .globl tohost
tohost: .word 0, 0
)",
                     kBegin, start_cluster(1 | others.cores), others.controller == Meanwhile::sleeps ? "wfi" : "nop",
                     change,
                     others.of_cores == Meanwhile::sleeps ? ".insn i 0x03, 6, a5, EU_WAIT_CLEAR_OFFSET(s0)" : "nop");
}

constexpr double kLoopOfWork = 200'000 * 4.0;
constexpr double kHzAtReset = 1525 * 32768.0;

void run_to_tohost(Gap8System& system) {
  system.soc.program_host().watch(*system.soc.program().symbol("tohost"));
  system.soc.run_cycles(10'000'000);
}

TEST(Gap8Cluster, ACoreSetsTheClockAtOnce) {
  const auto run = [](std::uint32_t factor, const Others& others) {
    Gap8System system(core_that_changes(set_cluster_clock(factor), others));
    run_to_tohost(system);
    EXPECT_EQ(system.soc.end(), End::host);
    const auto expected_s = kLoopOfWork / kHzAtReset + kLoopOfWork / (factor * 32768.0);
    EXPECT_NEAR(static_cast<double>(system.soc.now()) / kPsPerS, expected_s, 1e-3 * expected_s)
        << factor << ", controller " << static_cast<int>(others.controller) << ", cores " << others.cores;
    return system.soc.energy();
  };
  for (const std::uint32_t factor : {762U, 3050U}) {
    for (const std::uint32_t cores : {0U, 0b10U}) {
      const auto beside = run(factor, {Meanwhile::spins, cores, Meanwhile::spins});
      const auto alone = run(factor, {Meanwhile::sleeps, cores, Meanwhile::spins});
      for (const auto part : {Part::cluster_background, Part::cluster_cores, Part::leakage}) {
        EXPECT_GT(beside[part], 0);
        EXPECT_NEAR(alone[part], beside[part], 1e-3 * beside[part])
            << factor << ", cores " << cores << ", part " << static_cast<int>(part);
      }
    }
  }
}

TEST(Gap8Cluster, AChangeOfClockGivesTheSameBitsInStepsInterpretedAndFromAState) {
  const auto program = core_that_changes(set_cluster_clock(762), {Meanwhile::sleeps, 0xfe, Meanwhile::sleeps});
  const auto board = Gap8System::gap8();
  Gap8System straight(program, {}, board);
  Settings interpreted;
  interpreted.translate = false;
  Gap8System slow(program, interpreted, board);
  Gap8System steps(program, {}, board);
  Gap8System second(program, {}, board);
  straight.soc.advance(30 * kMs);
  slow.soc.advance(30 * kMs);
  EXPECT_TRUE(mebots::test::same_state(slow.soc, straight.soc));
  double last_j = 0;
  for (std::int64_t time = 0; time < 20 * kMs; time += 7'919) {
    steps.soc.advance(time);
    const auto total_j = steps.soc.energy().total_j();
    ASSERT_GE(total_j, last_j) << "at " << time << " ns";
    last_j = total_j;
  }
  state::restore(second.soc, state::save(steps.soc));
  for (auto* system : {&steps, &second}) {
    system->soc.advance(30 * kMs);
    EXPECT_TRUE(mebots::test::same_state(system->soc, straight.soc));
  }
}

TEST(Gap8Cluster, RunLastsUntilACoreSwitchesTheClusterOff) {
  Gap8System system(core_that_changes("li s0, SOC_CONTROL_BASE\n sw zero, SOC_CONTROL_CL_BYPASS_OFFSET(s0)", {}));
  run_to_tohost(system);
  EXPECT_EQ(system.soc.end(), End::none) << "nothing can continue";
  EXPECT_FALSE(system.soc.cluster()->powered());
  const auto expected_s = kLoopOfWork / kHzAtReset;
  const auto now = system.soc.now();
  EXPECT_NEAR(static_cast<double>(now) / kPsPerS, expected_s, 1e-3 * expected_s);
  EXPECT_NEAR(static_cast<double>(system.soc.cluster()->powered_time(now)) / kPsPerS, expected_s, 1e-3 * expected_s);
  EXPECT_GT(static_cast<double>(system.soc.sleep_time()) / kPsPerS, 0.99 * expected_s);
}

/// Firmware may change the clocks for each picture. Then loads from L2 and refills take other numbers of the cluster's
/// cycles, but the translated code stays valid.
TEST(Gap8Cluster, CodeIsDecodedAndTranslatedOnceForAllClocks) {
  const auto program =
      Gap8System::assembled(fmt::format(R"({}{}
2:  li a2, 200
3:  addi a2, a2, -1
    bnez a2, 3b
    {}
    li a2, 200
4:  addi a2, a2, -1
    bnez a2, 4b
    {}
    j 2b
core: li s1, L2_BASE + 0x40000
5:  lw a0, 0(s1)
    addi a1, a1, 1
    addi a1, a1, 1
    addi a1, a1, 1
    j 5b
fault: j fault
)",
                                        kBegin, start_cluster(0xff), set_cluster_clock(762), set_cluster_clock(3050)));
  Gap8System system(program);
  Settings without_translation;
  without_translation.translate = false;
  Gap8System interpreted(program, without_translation);
  Gap8System restored(program);
  system.soc.advance(10 * kMs);
  const auto& controller = system.soc.hart().code();
  const auto& cluster = system.soc.cluster()->hart(0).code();
  const auto decoded = controller.blocks.decoded() + cluster.blocks.decoded();
  const auto translated = controller.instructions_translated() + cluster.instructions_translated();
  if (translate::can_translate()) {
    EXPECT_GT(cluster.instructions_translated(), 0U);
    EXPECT_GT(controller.instructions_translated(), 0U);
  }
  state::restore(restored.soc, state::save(system.soc));
  for (int ms = 11; ms <= 30; ++ms) {
    for (auto* each : {&system, &interpreted, &restored}) each->soc.advance(ms * kMs);
    ASSERT_TRUE(mebots::test::same_state(interpreted.soc, system.soc)) << ms;
    ASSERT_TRUE(mebots::test::same_state(restored.soc, system.soc)) << ms;
  }
  EXPECT_GT(system.soc.hart().counters().instructions, 100'000U) << "hundreds of changes";
  EXPECT_EQ(controller.blocks.decoded() + cluster.blocks.decoded(), decoded);
  EXPECT_EQ(controller.instructions_translated() + cluster.instructions_translated(), translated);
}

/// A core that fell asleep before a change of the clock has counted periods of the old clock. Its time must not be
/// later than the present.
TEST(Gap8Cluster, SleepingCoresHaveATimeAfterAChangeOfClock) {
  Gap8System by_core(core_that_changes(set_cluster_clock(762), {Meanwhile::sleeps, 0b10}), {}, Gap8System::gap8());
  run_to_tohost(by_core);
  EXPECT_LE(by_core.soc.core_time(2), by_core.soc.now());
  const auto program = fmt::format(R"({}{}
    li t0, 10000
2:  addi t0, t0, -1
    bnez t0, 2b
    {}
3:  wfi
    j 3b
core: li s0, EU_BASE
4:  .insn i 0x03, 6, a5, EU_WAIT_CLEAR_OFFSET(s0)
    j 4b
fault: j fault
)",
                                   kBegin, start_cluster(1), set_cluster_clock(762));
  Gap8System by_controller(program);
  by_controller.soc.run_cycles(10'000'000);
  EXPECT_EQ(by_controller.soc.now(), by_controller.soc.core_time());
}

}  // namespace
}  // namespace mebots::soc::test
