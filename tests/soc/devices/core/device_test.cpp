// SPDX-License-Identifier: Apache-2.0
#include "board_system.hpp"

#include "mebots/error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mebots::soc::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Console, PrintsLines) {
  BoardSystem system(R"(
_start: li s0, CONSOLE_BASE
    la s1, text
1:  lbu a0, 0(s1)
    beqz a0, 2f
    sw a0, CONSOLE_PUTCHAR_OFFSET(s0)
    addi s1, s1, 1
    j 1b
2:  li s0, POWER_MANAGER_BASE
    li a0, 42
    sw a0, POWER_MANAGER_EXIT_OFFSET(s0)
3:  j 3b
text: .asciz "hello\n\nworld\nrest"
)");
  system.soc.advance(1 * kMs);
  EXPECT_THAT(system.console, ElementsAre("hello", "", "world", "rest")) << "the unfinished line comes at the exit";
  EXPECT_EQ(system.soc.end(), End::exited);
  EXPECT_EQ(system.soc.exit_code(), 42);
}

TEST(Mission, ShowsTheChipsClocksAndVoltage) {
  Settings settings;
  settings.clock_hz = 50e6;
  settings.cluster_clock_hz = 25e6;
  settings.voltage_v = 1.05;
  BoardSystem system(R"(
_start: li s0, MISSION_BASE
    lw s1, MISSION_CORE_CLOCK_OFFSET(s0)
    lw s2, MISSION_CLUSTER_CLOCK_OFFSET(s0)
    lw s3, MISSION_SUPPLY_VOLTAGE_OFFSET(s0)
1:  j 1b
)",
                     settings);
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.soc.hart().reg(9), 50'000'000U);
  EXPECT_EQ(system.soc.hart().reg(18), 25'000'000U);
  EXPECT_EQ(system.soc.hart().reg(19), 1'050U);
}

TEST(PowerManager, ExitEndsTheFirmwareWhileTimeContinues) {
  BoardSystem system(
      "_start: li s0, POWER_MANAGER_BASE\nli a0, -1\nsw a0, POWER_MANAGER_EXIT_OFFSET(s0)\nli s1, 1\n1: j 1b\n");
  system.soc.advance(5 * kMs);
  EXPECT_EQ(system.soc.hart().reg(9), 0U) << "nothing runs after the store";
  EXPECT_EQ(system.soc.exit_code(), -1);
  EXPECT_EQ(system.soc.now(), 5 * kMs * kPsPerNs);
}

TEST(PowerManager, ChangesTheClockWhileRunningWithinTheLimitsOfTheVoltage) {
  BoardSystem system(R"(
_start: li s0, POWER_MANAGER_BASE
    li s1, 0x1C060000
    li a0, 250000000
    sw a0, POWER_MANAGER_CLOCK_HZ_OFFSET(s0)
    lw a1, POWER_MANAGER_CLOCK_HZ_OFFSET(s0)
    sw a1, 0(s1)
    li a0, 1000
    sw a0, POWER_MANAGER_VOLTAGE_MV_OFFSET(s0)
    lw a1, POWER_MANAGER_VOLTAGE_MV_OFFSET(s0)
    sw a1, 4(s1)
    lw a1, POWER_MANAGER_STATUS_OFFSET(s0)
    sw a1, 8(s1)
    li a1, 1
    sw a1, POWER_MANAGER_STATUS_OFFSET(s0)
    lw a1, POWER_MANAGER_STATUS_OFFSET(s0)
    sw a1, 12(s1)
    li a0, 150000000
    sw a0, POWER_MANAGER_CLOCK_HZ_OFFSET(s0)
    li a0, 1000
    sw a0, POWER_MANAGER_VOLTAGE_MV_OFFSET(s0)
    li a0, 150000001
    sw a0, POWER_MANAGER_CLOCK_HZ_OFFSET(s0)
    lw a1, POWER_MANAGER_STATUS_OFFSET(s0)
    sw a1, 16(s1)
    lw a1, POWER_MANAGER_CLOCK_HZ_OFFSET(s0)
    sw a1, 20(s1)
    li a0, 1250
    sw a0, POWER_MANAGER_VOLTAGE_MV_OFFSET(s0)
    lw a1, POWER_MANAGER_VOLTAGE_MV_OFFSET(s0)
    sw a1, 24(s1)
1:  j 1b
)");
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.result(0), 250000000U);
  EXPECT_EQ(system.result(1), 1200U) << "1.0 V does not carry 250 MHz";
  EXPECT_EQ(system.result(2), 1U) << "refused";
  EXPECT_EQ(system.result(3), 0U) << "cleared by writing 1";
  EXPECT_EQ(system.result(4), 1U);
  EXPECT_EQ(system.result(5), 150000000U);
  EXPECT_EQ(system.result(6), 1000U) << "1.25 V is above the limit";
}

TEST(Clock, ConvertsCyclesToTimeWithoutDrift) {
  Settings settings;
  settings.clock_hz = 123456789;
  BoardSystem system("_start: j _start\n", settings);
  system.soc.advance(1'000'000'000);
  const auto cycles = system.soc.hart().counters().cycles;
  // The last jump, of 2 cycles, starts at 1 s or earlier.
  EXPECT_GE(cycles, 123456789U);
  EXPECT_LE(cycles, 123456789U + 2);
}

TEST(Settings, OutsideTheChipsLimitsAreRefused) {
  Settings settings;
  settings.clock_hz = 250e6;
  settings.voltage_v = 1.0;
  try {
    const BoardSystem system("_start: j _start\n", settings);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("core.clock 250000000 Hz at core.supply_voltage 1 V"));
  }
}

TEST(Timer, WakesTheSleepingCoreAtItsNanosecond) {
  BoardSystem system(R"(
_start: la t0, handler
    csrw mtvec, t0
    li s0, TIMER_BASE
    li s1, 0x1C060000
    li a0, 12345678
    sw a0, TIMER_COMPARE_LO_OFFSET(s0)
    sw zero, TIMER_COMPARE_HI_OFFSET(s0)
    li a0, 1 << TIMER_INTERRUPT
    csrw mie, a0
    csrwi mstatus, 8
1:  wfi
    j 1b
    .balign 4
handler: lw a1, TIMER_TIME_LO_OFFSET(s0)
    sw a1, 0(s1)
    csrr a1, mcause
    sw a1, 4(s1)
    lw a1, 8(s1)
    addi a1, a1, 1
    sw a1, 8(s1)
    li a1, -1
    sw a1, TIMER_COMPARE_LO_OFFSET(s0)
    sw a1, TIMER_COMPARE_HI_OFFSET(s0)
    mret
)");
  system.soc.advance(20 * kMs);
  EXPECT_EQ(system.result(1), 0x80000007U);
  EXPECT_EQ(system.result(2), 1U) << "once: the line falls with the new compare";
  // 12345678 ns is cycle 1234567.8: the core wakes at the next edge, 12345680 ns. Trap entry takes 4 cycles.
  EXPECT_EQ(system.result(0), 12345680U + 40U);
  EXPECT_LT(system.soc.hart().counters().cycles, 200U) << "sleep is skipped, not executed";
  EXPECT_NEAR(static_cast<double>(system.soc.sleep_time()), 20e9, 2e6) << "ps: all but some hundred cycles of 10 ns";
}

TEST(Timer, CarriesIntoItsHighWordAndLatchesIt) {
  BoardSystem system(R"(
_start: li s0, TIMER_BASE
    li s1, 0x1C060000
1:  lw a0, TIMER_TIME_LO_OFFSET(s0)
    lw a1, TIMER_TIME_HI_OFFSET(s0)
    sw a0, 0(s1)
    sw a1, 4(s1)
    li a2, 1000
2:  addi a2, a2, -1
    bnez a2, 2b
    j 1b
)");
  system.soc.advance(5'000'000'000);
  const auto time_ns = std::uint64_t{system.result(1)} << 32 | system.result(0);
  EXPECT_NEAR(static_cast<double>(time_ns), 5e9, 50e3) << "ns: read every 4000 cycles of 10 ns";
}

TEST(Flight, SendsSetPointsOnlyAllTogether) {
  BoardSystem system(R"(
_start: li s0, FLIGHT_BASE
    li a0, 2
    sw a0, FLIGHT_MODE_OFFSET(s0)
    li a0, -250000
    sw a0, FLIGHT_VELOCITY_Y_OFFSET(s0)
    li a0, 10000
1:  addi a0, a0, -1
    bnez a0, 1b
    sw zero, FLIGHT_COMMIT_OFFSET(s0)
    li a0, 99
    sw a0, FLIGHT_MODE_OFFSET(s0)
    sw zero, FLIGHT_COMMIT_OFFSET(s0)
    li a0, 3
    sw a0, FLIGHT_MODE_OFFSET(s0)
    li a0, -1000000
    sw a0, FLIGHT_ALTITUDE_OFFSET(s0)
    sw zero, FLIGHT_COMMIT_OFFSET(s0)
2:  j 2b
)");
  system.soc.advance(100'000);
  EXPECT_EQ(system.output("setpoint.mode"), 0);
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.output("setpoint.mode"), 2);
  EXPECT_EQ(system.output("setpoint.velocity.y"), -0.25);
  ASSERT_EQ(system.faults.size(), 2U);
  EXPECT_THAT(system.faults[0], HasSubstr("MODE 99"));
  EXPECT_THAT(system.faults[1], HasSubstr("ALTITUDE -1000000"));
}

TEST(Registers, GiveInputsInTheirUnits) {
  BoardSystem system(R"(
_start: li s0, FLIGHT_BASE
    li s1, 0x1C060000
    li s2, BATTERY_BASE
    lw a0, FLIGHT_RANGE_OFFSET(s0)
    sw a0, 0(s1)
    lw a0, FLIGHT_YAW_OFFSET(s0)
    sw a0, 4(s1)
    lw a0, BATTERY_VOLTAGE_OFFSET(s2)
    sw a0, 8(s1)
    lw a0, BATTERY_STATE_OF_CHARGE_OFFSET(s2)
    sw a0, 12(s1)
    lw a0, FLIGHT_PHASE_OFFSET(s0)
    sw a0, 16(s1)
    lw a0, FLIGHT_FORWARD_VELOCITY_OFFSET(s0)
    sw a0, 20(s1)
1:  j 1b
)");
  *system.soc.devices().input("flight.phase") = 2;
  *system.soc.devices().input("flight.range") = 1.0203;
  *system.soc.devices().input("flight.forward_velocity") = 1e9;
  *system.soc.devices().input("flight.yaw") = -0.5;
  *system.soc.devices().input("battery.state_of_charge") = 0.25;
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.result(0), 1020300U);
  EXPECT_EQ(system.result(1), static_cast<std::uint32_t>(-500000));
  EXPECT_EQ(system.result(2), 3700U);
  EXPECT_EQ(system.result(3), 250000U);
  EXPECT_EQ(system.result(4), 2U);
  EXPECT_EQ(system.result(5), 0x7fffffffU) << "more than the register holds: saturated";
}

TEST(Request, IsVisibleAtTheNextCommunicationPoint) {
  // At 100 MHz, about 99 instructions precede the commit. All except a store take one cycle.
  const auto program = BoardSystem::assembled(
      "_start: .option norvc\nli s0, FLIGHT_BASE\naddi a0, zero, 3\nsw a0, FLIGHT_MODE_OFFSET(s0)\n.rept "
      "95\nnop\n.endr\n"
      "sw zero, FLIGHT_COMMIT_OFFSET(s0)\n1: j 1b\n");
  // `at` becomes the time of the commit. It is measured, because li FLIGHT_BASE may be one or two instructions.
  BoardSystem probe(program, {}, BoardSystem::without_caches());
  std::int64_t at = 0;
  while (probe.output("setpoint.mode") == 0) probe.soc.advance(at += 1);
  EXPECT_EQ(at % 10, 0) << "starts on a clock edge and is out at that very nanosecond";
  EXPECT_NEAR(static_cast<double>(at), 1065, 6)
      << "ns: 98 or 99 cycles before it, and 8 for the way of the first store";
  BoardSystem late(program, {}, BoardSystem::without_caches());
  late.soc.advance(at - 1);
  EXPECT_EQ(late.output("setpoint.mode"), 0) << "a nanosecond early: stays pending";
  late.soc.advance(at);
  EXPECT_EQ(late.output("setpoint.mode"), 3);
}

TEST(Bus, RefusesAccessesOtherThanAlignedWords) {
  BoardSystem system("_start: li s0, TIMER_BASE\nat: lbu a0, 0(s0)\n");
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.soc.end(), End::faulted);
  ASSERT_EQ(system.faults.size(), 1U);
  EXPECT_THAT(system.faults[0], HasSubstr("load access fault (mcause 5, mtval 0x1a18b000) at pc 0x1c00000"));
  EXPECT_THAT(system.faults[0], HasSubstr("in at: lbu a0, 0(s0)"));
}

TEST(Board, IsRefusedIfALibraryHasAnotherLayoutOfRegisters) {
  auto board = read_board(MEBOTS_SOURCE_DIR "/configs/boards/ai_deck.json");
  board.devices[1].registers[0].offset = 0x40;
  try {
    const Soc soc(board, gap8(), Settings{}, BoardSystem::assembled("_start: j _start\n"), {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("registers of device timer"));
  }
}

BoardDescription with_two_timers() {
  auto board = read_board(MEBOTS_SOURCE_DIR "/configs/boards/gap8_bare.json");
  auto second = board.devices[1];
  second.name = "watchdog";
  second.base = 0x1A18C000;
  second.interrupt = 17;
  board.devices.push_back(second);
  return board;
}

TEST(Board, MayHaveTwoDevicesOfOneKind) {
  BoardSystem system(R"(
_start: la t0, handler
    csrw mtvec, t0
    li s0, TIMER_BASE
    li s1, 0x1C060000
    li s2, 0x1A18C000
    li a0, 1000000
    sw a0, TIMER_COMPARE_LO_OFFSET(s0)
    sw zero, TIMER_COMPARE_HI_OFFSET(s0)
    li a0, 3000000
    sw a0, TIMER_COMPARE_LO_OFFSET(s2)
    sw zero, TIMER_COMPARE_HI_OFFSET(s2)
    li a0, (1 << TIMER_INTERRUPT) | (1 << 17)
    csrw mie, a0
    csrwi mstatus, 8
1:  wfi
    j 1b
    .balign 4
handler: csrr a0, mcause
    andi a1, a0, 31
    slli a1, a1, 2
    add a1, a1, s1
    lw a2, TIMER_TIME_LO_OFFSET(s0)
    sw a2, 0(a1)
    andi a0, a0, 31
    li a1, -1
    li a2, TIMER_INTERRUPT
    beq a0, a2, 2f
    sw a1, TIMER_COMPARE_HI_OFFSET(s2)
    mret
2:  sw a1, TIMER_COMPARE_HI_OFFSET(s0)
    mret
)",
                     {}, with_two_timers());
  system.soc.advance(10 * kMs);
  EXPECT_NEAR(system.result(7), 1e6, 1000) << "ns: the way into the handler";
  EXPECT_NEAR(system.result(17), 3e6, 1000);
}

/// Returns the error of the chip's constructor; empty if it accepts the board.
std::string refusal(const BoardDescription& board) {
  try {
    const Soc soc(board, gap8(), Settings{}, BoardSystem::assembled("_start: j _start\n"), {});
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(Board, IsRefusedIfAKindIsUnknown) {
  auto board = with_two_timers();
  EXPECT_EQ(refusal(board), "");
  board.devices.back().kind = "timr";
  EXPECT_THAT(refusal(board), HasSubstr("device watchdog: the kind 'timr' is unknown. Did you mean 'timer'?"));
  board.devices.back() = board.devices[2];
  board.devices.back().name = "other";
  EXPECT_THAT(refusal(board), HasSubstr("other is a second power manager"));
}

TEST(Board, IsRefusedIfALibraryIsMissing) {
  auto board = with_two_timers();
  board.libraries = {"wheels.so"};
  EXPECT_THAT(refusal(board), HasSubstr("its library wheels.so was not found"));
}

TEST(Program, OutsideTheMemoriesIsRefused) {
  try {
    const BoardSystem system(assemble("_start: j _start\n", 0x20000000));
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("0x20000000"));
  }
}

}  // namespace
}  // namespace mebots::soc::test
