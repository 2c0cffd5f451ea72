// SPDX-License-Identifier: Apache-2.0
#include "hart/csr_numbers.hpp"
#include "machine.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace mebots::soc::test {
namespace {

constexpr unsigned kTimer = 7;
constexpr unsigned kExternal = 11;

/// Returns a program that increments a0 in a loop. Its handler stores mcause in s2 and mepc in s3, masks all interrupts
/// and returns.
std::string counting(unsigned mode, std::string_view enable) {
  return fmt::format(R"(
_start: .option norvc
    la t0, vectors
    addi t0, t0, {}
    csrw mtvec, t0
    {}
1:  addi a0, a0, 1
    j 1b
    .balign 128
vectors: .rept 32
    j handler
    .endr
handler: csrr s2, mcause
    csrr s3, mepc
    csrw mie, zero
    addi s4, s4, 1
    mret
)",
                     mode, enable);
}

constexpr std::string_view kEnableAll = "li t1, -1\ncsrw mie, t1\ncsrwi mstatus, 8";

TEST(Interrupt, IsTakenAtTheNextInstructionAndReturnsThere) {
  Machine machine(counting(0, kEnableAll));
  machine.run(200);
  const auto before = machine.reg(10);
  const auto pc = machine.hart().pc();
  machine.hart().set_interrupt(kTimer, true);
  machine.run(400);
  EXPECT_EQ(machine.reg(18), cause::kInterrupt | kTimer);
  EXPECT_EQ(machine.reg(19), pc);
  EXPECT_EQ(machine.reg(20), 1U);
  EXPECT_GT(machine.reg(10), before) << "continues to count";
}

TEST(Interrupt, WaitsUntilItIsEnabled) {
  Machine masked(counting(0, "csrwi mstatus, 8"));
  masked.hart().set_interrupt(kTimer, true);
  masked.run(300);
  EXPECT_EQ(masked.reg(20), 0U) << "not enabled in mie";
  Machine off(counting(0, "li t1, -1\ncsrw mie, t1"));
  off.hart().set_interrupt(kTimer, true);
  off.run(300);
  EXPECT_EQ(off.reg(20), 0U) << "mstatus.MIE is 0";
}

TEST(Interrupt, IsTakenInOrderOfPriority) {
  Machine machine(counting(0, "csrwi mstatus, 8\nli t1, -1\ncsrw mie, t1"));
  machine.hart().set_interrupt(kTimer, true);
  machine.hart().set_interrupt(kExternal, true);
  machine.run(300);
  EXPECT_EQ(machine.reg(18), cause::kInterrupt | kExternal);
}

TEST(Interrupt, InVectoredModeEntersItsOwnVector) {
  const auto program = assemble(fmt::format(R"(
_start: .option norvc
    la t0, vectors
    addi t0, t0, 1
    csrw mtvec, t0
    {}
1:  j 1b
    .balign 128
vectors: .rept 11
    j wrong
    .endr
    j right
    .rept 20
    j wrong
    .endr
wrong: li a1, 1
    csrw mie, zero
    mret
right: li a1, 2
    csrw mie, zero
    mret
)",
                                            kEnableAll));
  Machine machine(program);
  machine.run(100);
  machine.hart().set_interrupt(kExternal, true);
  machine.run(300);
  EXPECT_EQ(machine.reg(11), 2U);
}

TEST(Interrupt, HandlerRunsWithInterruptsOffAndMretTurnsThemOn) {
  Machine machine(fmt::format(R"(
_start: la t0, handler
    csrw mtvec, t0
    {}
1:  csrr s5, mstatus
    j 1b
    .balign 4
handler: csrr s2, mstatus
    csrw mie, zero
    mret
)",
                              kEnableAll));
  machine.hart().set_interrupt(kTimer, true);
  machine.run(500);
  EXPECT_EQ(machine.reg(18), 0x1880U) << "MPIE keeps what MIE was, MIE is 0";
  EXPECT_EQ(machine.reg(21), 0x1888U);
}

TEST(WaitForInterrupt, SleepsUntilAnEnabledOneIsPendingEvenWithMieOff) {
  Machine machine(fmt::format("_start: li t0, 128\ncsrw mie, t0\nwfi\nli a0, 1\n{}", kEnd));
  EXPECT_EQ(machine.run(), Stop::sleeping);
  EXPECT_EQ(machine.reg(10), 0U);
  EXPECT_EQ(machine.run(), Stop::sleeping) << "nothing has happened";
  machine.hart().set_interrupt(kExternal, true);
  EXPECT_EQ(machine.run(), Stop::sleeping) << "not an enabled one";
  machine.hart().set_interrupt(kTimer, true);
  EXPECT_EQ(machine.run(), Stop::watch);
  EXPECT_EQ(machine.reg(10), 1U);
}

TEST(WaitForInterrupt, DoesNotSleepWhenOneIsPendingAlready) {
  Machine machine(fmt::format("_start: li t0, 128\ncsrw mie, t0\nwfi\nli a0, 1\n{}", kEnd));
  machine.hart().set_interrupt(kTimer, true);
  EXPECT_EQ(machine.run(), Stop::watch);
}

}  // namespace
}  // namespace mebots::soc::test
