// SPDX-License-Identifier: Apache-2.0
#include "board_system.hpp"
#include "support/same_state.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace mebots::soc::test {
namespace {

/// Returns a program with timer interrupts, pictures, sleeps, divisions, printing and voltage changes.
const Elf& busy_program() {
  static const auto program = BoardSystem::assembled(R"(
_start: la t0, handler
    csrw mtvec, t0
    li s0, TIMER_BASE
    li s1, CAMERA_BASE
    li s2, 0x1C060000
    li s3, 700000
    li s4, POWER_MANAGER_BASE
    li s5, 0x1B000000
    li a0, 0x1C040000
    sw a0, CAMERA_BUFFER_OFFSET(s1)
    li a0, 4096
    sw a0, CAMERA_BUFFER_SIZE_OFFSET(s1)
    sw s3, TIMER_COMPARE_LO_OFFSET(s0)
    sw zero, TIMER_COMPARE_HI_OFFSET(s0)
    li a0, (1 << CAMERA_INTERRUPT) | (1 << TIMER_INTERRUPT)
    csrw mie, a0
    csrwi mstatus, 8
1:  wfi
    li a0, 3000
2:  addi a0, a0, -1
    div a1, s3, a0
    sw a1, 1(s5)
    lw a2, 1(s5)
    add a3, a3, a2
    bnez a0, 2b
    li a0, 1000
    sw a0, POWER_MANAGER_VOLTAGE_MV_OFFSET(s4)
    li a0, 1200
    sw a0, POWER_MANAGER_VOLTAGE_MV_OFFSET(s4)
    j 1b
    .balign 4
handler: csrr a4, mcause
    andi a4, a4, 15
    li a5, TIMER_INTERRUPT
    beq a4, a5, 3f
    li a5, 2
    sw a5, CAMERA_STATUS_OFFSET(s1)
    lw a5, 0(s2)
    addi a5, a5, 1
    sw a5, 0(s2)
    mret
3:  lw a5, TIMER_COMPARE_LO_OFFSET(s0)
    add a5, a5, s3
    sw a5, TIMER_COMPARE_LO_OFFSET(s0)
    li a5, 1
    sw a5, CAMERA_CONTROL_OFFSET(s1)
    li a5, CONSOLE_BASE
    li a4, '.'
    sw a4, CONSOLE_PUTCHAR_OFFSET(a5)
    mret
)");
  return program;
}

const std::vector<std::uint8_t> kPicture(64UL * 30, 7);

/// Runs to the end in steps of `h_ns`, which must divide 10 ms. Pictures arrive at multiples of 10 ms.
void run(BoardSystem& system, std::int64_t h_ns, std::int64_t end_ns) {
  for (auto t = system.soc.now() / kPsPerNs; t < end_ns; t += h_ns) {
    auto& camera = system.camera();
    if (t % 10'000'000 == 0 && camera.wants(camera.requests())) camera.offer(kPicture, system.soc.now());
    system.soc.advance(t + h_ns);
  }
}

void expect_same(const BoardSystem& a, const BoardSystem& b) {
  const auto& x = a.soc.hart().counters();
  const auto& y = b.soc.hart().counters();
  EXPECT_EQ(x.instructions, y.instructions);
  EXPECT_EQ(x.cycles, y.cycles);
  EXPECT_EQ(x.accesses, y.accesses);
  EXPECT_EQ(a.soc.sleep_time(), b.soc.sleep_time());
  EXPECT_EQ(a.soc.energy().total_j(), b.soc.energy().total_j());
  EXPECT_EQ(a.camera_energy_j(), b.camera_energy_j());
  for (unsigned i = 0; i < 32; ++i) EXPECT_EQ(a.soc.hart().reg(i), b.soc.hart().reg(i)) << i;
  EXPECT_EQ(a.result(0), b.result(0));
}

TEST(State, RestoredInAnotherChipContinuesWithTheSameBits) {
  BoardSystem straight(busy_program(), {}, BoardSystem::narrow());
  BoardSystem first(busy_program(), {}, BoardSystem::narrow());
  BoardSystem second(busy_program(), {}, BoardSystem::narrow());
  constexpr std::int64_t kHalf = 53'000'000;
  constexpr std::int64_t kEnd = 110'000'000;
  run(straight, 1'000'000, kEnd);
  run(first, 1'000'000, kHalf);
  const auto bytes = state::save(first.soc);
  state::restore(second.soc, bytes);
  EXPECT_TRUE(mebots::test::same_state(second.soc, first.soc));
  run(second, 1'000'000, kEnd);
  EXPECT_TRUE(mebots::test::same_state(second.soc, straight.soc));
  expect_same(straight, second);
  EXPECT_GT(straight.result(0), 2U) << "pictures did come";
}

TEST(State, CanBeRestoredAfterTheRunHasContinued) {
  BoardSystem system(busy_program(), {}, BoardSystem::narrow());
  run(system, 1'000'000, 31'000'000);
  const auto bytes = state::save(system.soc);
  run(system, 1'000'000, 60'000'000);
  const auto later = state::save(system.soc);
  state::restore(system.soc, bytes);
  run(system, 1'000'000, 60'000'000);
  EXPECT_EQ(state::first_difference(system.soc, state::save(system.soc), later), std::nullopt);
}

TEST(StepSize, DoesNotChangeTheRun) {
  BoardSystem reference(busy_program(), {}, BoardSystem::narrow());
  run(reference, 10'000'000, 100'000'000);
  for (const std::int64_t h_ns : {2'000'000, 1'000'000, 250'000, 40'000}) {
    BoardSystem system(busy_program(), {}, BoardSystem::narrow());
    run(system, h_ns, 100'000'000);
    expect_same(reference, system);
    EXPECT_TRUE(mebots::test::same_state(system.soc, reference.soc)) << "every byte, at h = " << h_ns << " ns";
  }
}

/// A load directly before an access to a device costs a cycle, even if a block ends between the two. A block ends at
/// the end of a step, or after at most 64 instructions.
TEST(StepSize, DoesNotChangeTheTimeOfADeviceAccessAfterALoad) {
  for (int before = 60; before < 68; ++before) {
    const auto program = BoardSystem::assembled(fmt::format(R"(
_start: la s1, pointer
    li s2, 0x1C060000
    li a3, 500
1:  .rept {}
    addi a1, a1, 1
    .endr
    lw a0, 0(s1)
    lw a2, TIMER_TIME_LO_OFFSET(a0)
    lw a0, 0(s1)
    lw a4, TIMER_TIME_LO_OFFSET(a0)
    add a5, a2, a5
    xor a5, a5, a4
    addi a3, a3, -1
    bnez a3, 1b
    sw a5, 0(s2)
2:  wfi
    j 2b
    .balign 4
pointer: .word TIMER_BASE
)",
                                                            before));
    BoardSystem whole(program);
    whole.soc.advance(2'000'000);
    BoardSystem split(program);
    for (std::int64_t t = 10; t < 400'000; t += 10) split.soc.advance(t);
    split.soc.advance(2'000'000);
    ASSERT_NE(whole.result(0), 0U);
    EXPECT_EQ(split.result(0), whole.result(0)) << before << " instructions before";
    EXPECT_TRUE(mebots::test::same_state(split.soc, whole.soc));
  }
}

}  // namespace
}  // namespace mebots::soc::test
