// SPDX-License-Identifier: Apache-2.0
#include "board_system.hpp"

#include "mebots/error.hpp"

#include <gtest/gtest.h>

namespace mebots::soc::test {
namespace {

constexpr double kMemoryLeakageW = 5.2e-6 * (524288 + 65536 + 16384) / 4096;
constexpr double kRounding = 1e-12;  // relative: sums of doubles

TEST(Energy, OfAWorkingCoreIsInstructionsAndAccessesPlusLeakage) {
  // Turns of one load, one store, one addition, one jump.
  BoardSystem system("_start: li s0, 0x1C060000\n1: lw a0, 0(s0)\nsw a1, 4(s0)\naddi a2, a2, 1\nj 1b\n");
  system.soc.advance(10'000'000);
  const auto& counters = system.soc.hart().counters();
  const auto ledger = system.soc.energy();
  EXPECT_NEAR(static_cast<double>(counters.accesses), static_cast<double>(counters.instructions) / 2, 2);
  const auto instructions_j = 4.98e-12 * static_cast<double>(counters.instructions);
  const auto memory_j = 2.124e-12 * static_cast<double>(counters.accesses);
  EXPECT_NEAR(ledger.core_active_j, instructions_j, kRounding * instructions_j);
  EXPECT_NEAR(ledger.memory_j, memory_j, kRounding * memory_j);
  const auto leakage_j = (35.5e-6 + kMemoryLeakageW) * 0.01;
  EXPECT_NEAR(ledger.leakage_j, leakage_j, kRounding * leakage_j);
  EXPECT_EQ(ledger.total_j(), ledger.core_active_j + ledger.memory_j + ledger.leakage_j);
}

TEST(Energy, OfASleepingCoreIsLeakageAndItsGatedClock) {
  BoardSystem system("_start: wfi\nj _start\n");
  system.soc.advance(1'000'000'000);
  const auto before = system.soc.energy();
  system.soc.advance(3'000'000'000);
  const auto after = system.soc.energy();
  const auto expected_j = 2 * (35.5e-6 + kMemoryLeakageW + 1.6e-6);
  EXPECT_NEAR(after.leakage_j - before.leakage_j, expected_j, kRounding * expected_j);
  EXPECT_EQ(after.core_active_j, before.core_active_j);
}

TEST(Energy, OfInstructionsGoesWithTheSquareOfTheVoltage) {
  constexpr auto kLoop = "_start: addi a0, a0, 1\nj _start\n";
  Settings low;
  low.voltage_v = 1.0;
  BoardSystem at_1v2(kLoop);
  BoardSystem at_1v0(kLoop, low);
  at_1v2.soc.advance(1'000'000);
  at_1v0.soc.advance(1'000'000);
  EXPECT_NEAR(at_1v0.soc.energy().core_active_j / at_1v2.soc.energy().core_active_j, 1 / 1.44, kRounding);
}

TEST(Energy, ChangesItsPriceWhenTheFirmwareChangesTheVoltage) {
  BoardSystem system(R"(
_start: li s0, POWER_MANAGER_BASE
    li a0, 1000
    sw a0, POWER_MANAGER_VOLTAGE_MV_OFFSET(s0)
1:  addi a1, a1, 1
    j 1b
)");
  system.soc.advance(1'000'000);
  const auto before = system.soc.energy();
  const auto instructions = system.soc.hart().counters().instructions;
  system.soc.advance(2'000'000);
  const auto spent_j = system.soc.energy().core_active_j - before.core_active_j;
  const auto expected_j =
      4.98e-12 / 1.44 * static_cast<double>(system.soc.hart().counters().instructions - instructions);
  EXPECT_NEAR(spent_j, expected_j, 1e-9 * expected_j) << "difference of two sums";
}

TEST(Energy, StopsWhenThePowerIsGone) {
  BoardSystem system("_start: j _start\n");
  system.soc.advance(1'000'000);
  system.soc.power_off();
  const auto ledger = system.soc.energy();
  const auto camera_j = system.soc.camera_energy_j();
  const auto cycles = system.soc.hart().counters().cycles;
  system.soc.advance(9'000'000);
  EXPECT_EQ(system.soc.energy().total_j(), ledger.total_j());
  EXPECT_EQ(system.soc.camera_energy_j(), camera_j);
  EXPECT_EQ(system.soc.hart().counters().cycles, cycles);
  EXPECT_FALSE(system.soc.running());
}

TEST(ChipFile, WithAnUnknownKeyOrAMissingSourceIsRefused) {
  EXPECT_THROW(parse_chip(R"({"name": "x", "clok": 1})", "x.json"), Error);
  EXPECT_THROW(parse_chip("{", "x.json"), Error);
  EXPECT_THROW(parse_chip(R"({"core": "z80"})", "x.json"), Error);
}

}  // namespace
}  // namespace mebots::soc::test
