// SPDX-License-Identifier: Apache-2.0
#include "board_system.hpp"

#include "mebots/data/document.hpp"
#include "mebots/error.hpp"

#include <gmock/gmock.h>

namespace mebots::soc::test {
namespace {

// Values of params/gap8.json at 1.2 V and 25 C.
constexpr double kInstructionJ = 30.03e-12;
constexpr double kAccessJ = 12.81e-12;
constexpr double kGatedW = 9.648e-6;
constexpr double kBackgroundW = 17.13e-3 * 100 / 250;  // at 100 of the 250 MHz of the reference
constexpr double kLeakageW = 35.5e-6 + 5.2e-6 * (524288 + 16384) / 4096;
constexpr double kRounding = 1e-12;  // relative tolerance for sums of doubles

constexpr auto kForEver = "_start: addi a0, a0, 1\nj _start\n";

TEST(EnergyTable, InterpolatesLinearlyAndRefusesPointsOutside) {
  const std::string json = R"({"unit": "W", "source": "here", "values": {
      "0": {"1.0": {"any": 1}, "1.2": {"0": 2, "100": 4}}, "50": {"1.0": {"any": 3}, "1.2": {"any": 5}}}})";
  const auto read = [&](std::string_view unit) {
    return data::Document(json, "x.json").read([&](const data::Node& root) {
      return EnergyTable::read(root, unit, 10);
    });
  };
  const EnergyTable table = read("W");
  EXPECT_DOUBLE_EQ(table.at({0, 1.0, 7}), 10);
  EXPECT_DOUBLE_EQ(table.at({0, 1.2, 50}), 30);
  EXPECT_DOUBLE_EQ(table.at({0, 1.1, 50}), 20);
  EXPECT_DOUBLE_EQ(table.at({25, 1.1, 50}), 30);
  EXPECT_THROW(table.at({51, 1.1, 50}), Error);
  EXPECT_THROW(table.at({0, 1.3, 50}), Error);
  EXPECT_THROW(table.at({0, 1.2, 101}), Error);
  EXPECT_THROW(read("J"), Error);
}

TEST(Energy, IsInstructionsAccessesBackgroundAndLeakageForAWorkingCore) {
  BoardSystem system(
      BoardSystem::assembled("_start: li s0, 0x1C060000\n1: lw a0, 0(s0)\nsw a1, 4(s0)\naddi a2, a2, 1\nj 1b\n"), {},
      BoardSystem::without_caches());
  system.soc.advance(10'000'000);
  const auto& counters = system.soc.hart().counters();
  const auto ledger = system.soc.energy();
  EXPECT_NEAR(static_cast<double>(counters.accesses), static_cast<double>(counters.instructions) / 2, 2);
  const auto instructions_j = kInstructionJ * static_cast<double>(counters.instructions);
  const auto memory_j = kAccessJ * static_cast<double>(counters.accesses);
  EXPECT_NEAR(ledger[Part::fabric_controller], instructions_j, kRounding * instructions_j);
  EXPECT_NEAR(ledger[Part::l2], memory_j, kRounding * memory_j);
  EXPECT_NEAR(ledger[Part::fc_background], kBackgroundW * 0.01, kRounding * kBackgroundW);
  EXPECT_NEAR(ledger[Part::leakage], kLeakageW * 0.01, kRounding * kLeakageW);
  for (const auto part : {Part::cluster_cores, Part::fc_memory, Part::l1, Part::interconnect, Part::dma,
                          Part::cluster_background, Part::retention}) {
    EXPECT_EQ(ledger[part], 0) << kPartNames[static_cast<std::size_t>(part)];
  }
  EXPECT_EQ(ledger.total_j(), ledger.core_active_j() + ledger.memory_j() + ledger.standing_j());
}

TEST(Energy, GivesTheCurrentsOfTheCalibrationOnSilicon) {
  // Measured on a GAPuino at 1.2 V and 250 MHz, in reset and with its cluster off: 1.3 and 9.3 mA from a rail of 1.8 V
  // (bench/silicon/points.json).
  constexpr double kRailV = 1.8;
  auto board = read_board(MEBOTS_SOURCE_DIR "/configs/boards/gap8.json");
  EXPECT_EQ(board.energy, "gap8_silicon");
  const auto& energy = chip_of(board).energy;
  const OperatingPoint top{25, 1.2, 250e6};
  const auto leakage_w = energy.core_leakage.at(top) + energy.memory_leakage.at(top) * (524288 + 16384) / 4096;
  EXPECT_NEAR(leakage_w, kRailV * 1.3e-3, 1e-3 * leakage_w) << "four digits of each figure";
  const auto asleep_w = leakage_w + energy.fc_background.at(top) + energy.core_clock_gated.at(top);
  EXPECT_NEAR(asleep_w, kRailV * 9.3e-3, 1e-3 * asleep_w);
  board.energy = "gap8";
  EXPECT_EQ(&chip_of(board), &gap8());
  EXPECT_EQ(read_board(MEBOTS_SOURCE_DIR "/configs/boards/ai_deck.json").energy, "gap8_silicon");
}

TEST(Energy, IsGatedClockBackgroundAndLeakageForASleepingCore) {
  BoardSystem system("_start: wfi\nj _start\n");
  system.soc.advance(1'000'000'000);
  const auto before = system.soc.energy();
  system.soc.advance(3'000'000'000);
  const auto spent_j = system.soc.energy().total_j() - before.total_j();
  const auto expected_j = 2 * (kGatedW + kBackgroundW + kLeakageW);
  EXPECT_NEAR(spent_j, expected_j, 1e-9 * expected_j) << "difference of two sums";
}

TEST(Energy, IsProportionalToTheSquareOfTheVoltageForInstructions) {
  Settings low;
  low.voltage_v = 1.0;
  BoardSystem at_1v2(kForEver);
  BoardSystem at_1v0(kForEver, low);
  at_1v2.soc.advance(1'000'000);
  at_1v0.soc.advance(1'000'000);
  EXPECT_NEAR(at_1v0.soc.energy().core_active_j() / at_1v2.soc.energy().core_active_j(), 1 / 1.44, 1e-3)
      << "the table has four digits";
}

TEST(Energy, DoublesForLeakageFromRoomTemperatureToFifty) {
  Settings warm;
  warm.temperature_c = 50;
  BoardSystem at_25(kForEver);
  BoardSystem at_50(kForEver, warm);
  at_25.soc.advance(1'000'000);
  at_50.soc.advance(1'000'000);
  EXPECT_NEAR(at_50.soc.energy()[Part::leakage], 2 * at_25.soc.energy()[Part::leakage], 1e-12);
  EXPECT_EQ(at_50.soc.energy()[Part::fabric_controller], at_25.soc.energy()[Part::fabric_controller]);
}

TEST(Energy, FollowsAChangeOfTheVoltage) {
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
  const auto spent_j = system.soc.energy().core_active_j() - before.core_active_j();
  const auto expected_j = 20.85e-12 * static_cast<double>(system.soc.hart().counters().instructions - instructions);
  EXPECT_NEAR(spent_j, expected_j, 1e-9 * expected_j) << "difference of two sums";
}

TEST(Energy, NeverDecreasesBetweenInstructions) {
  BoardSystem system(R"(
_start: li s0, POWER_MANAGER_BASE
    li a0, 50000000
    li a1, 100000000
1:  sw a0, POWER_MANAGER_CLOCK_HZ_OFFSET(s0)
    sw a1, POWER_MANAGER_CLOCK_HZ_OFFSET(s0)
    j 1b
)");
  double spent_j = 0;
  for (std::int64_t now_ns = 3; now_ns < 20'000; now_ns += 3) {
    system.soc.advance(now_ns);
    const auto energy_j = system.soc.energy().total_j();
    ASSERT_GE(energy_j, spent_j) << now_ns;
    spent_j = energy_j;
  }
  EXPECT_GT(spent_j, 0);
}

TEST(Energy, IsZeroForTheClusterWhileItIsOff) {
  BoardSystem system(R"(
_start: li s0, POWER_MANAGER_BASE
    la a0, core
    sw a0, POWER_MANAGER_CLUSTER_BOOT_OFFSET(s0)
    li a0, 1
    sw a0, POWER_MANAGER_CLUSTER_POWER_OFFSET(s0)
    li a1, 50000
1:  addi a1, a1, -1
    bnez a1, 1b
    sw zero, POWER_MANAGER_CLUSTER_POWER_OFFSET(s0)
2:  wfi
    j 2b
core: wfi
    j core
)");
  // 50000 iterations of 4 cycles at 100 MHz take 2 ms; latency adds some cycles.
  system.soc.advance(5'000'000);
  const auto ledger = system.soc.energy();
  constexpr double kOnS = 2e-3;
  EXPECT_NEAR(ledger[Part::cluster_background], 17.13e-3 * 87 / 175 * kOnS, 1e-7 * 17.13e-3);
  EXPECT_NEAR(ledger[Part::cluster_cores], 8 * kGatedW * kOnS, 0.01 * 8 * kGatedW * kOnS) << "and 8 instructions";
  const auto cluster_leakage_w = 1.105e-3 + 8 * 35.5e-6 + 16 * 5.2e-6;
  EXPECT_NEAR(ledger[Part::leakage], kLeakageW * 5e-3 + cluster_leakage_w * kOnS, 1e-9);
  system.soc.advance(9'000'000);
  EXPECT_EQ(system.soc.energy()[Part::cluster_background], ledger[Part::cluster_background]);
}

/// Adds the counts of one core to those of the cluster.
void add(Activity& all, unsigned core, const CoreActivity& one) {
  auto& sum = all.of_cores[core];
  sum.instruction_fj += one.instruction_fj;
  sum.cycles += one.cycles;
  sum.l1_accesses += one.l1_accesses;
  sum.far_accesses += one.far_accesses;
  all.cluster_instruction_fj += one.instruction_fj;
  all.cluster_cycles += one.cycles;
  all.l1_accesses += one.l1_accesses;
  all.l2_accesses += one.far_accesses;
  all.far_words += one.far_accesses;
}

TEST(Energy, AddsUpOverTheClustersCoresToTheLedgerAtAllSettings) {
  EnergyMeter meter(gap8().energy, {0, 65536, 2}, {25, 1.2, 100e6, 175e6});
  Activity now;
  add(now, 0, {30'000'000, 1'000, 400, 7});
  add(now, 1, {7'000'000, 300, 20, 90});
  meter.change({25, 1.0, 50e6, 87e6}, now);
  const auto before_j = meter.core_j(1, now.of_cores[1]);
  add(now, 0, {5'000'000, 170, 30, 2});
  EXPECT_EQ(meter.core_j(1, now.of_cores[1]), before_j) << "it did nothing";
  // The meter computes the time with gated clocks as the time of all cores, minus the cycles of awake cores. No time
  // has passed here, so only the second term remains. core_j() contains the same term.
  const auto ledger = meter.at(now);
  const auto all_j = ledger[Part::cluster_cores] + ledger[Part::l1] + ledger[Part::l2] + ledger[Part::interconnect];
  EXPECT_NEAR(meter.core_j(0, now.of_cores[0]) + before_j, all_j, kRounding * all_j);
  EXPECT_GT(meter.core_j(0, now.of_cores[0]), before_j);
}

TEST(Retention, OnlyPowersTheMemoriesAndDelaysTheWakeUp) {
  // Requests retention, sleeps until the timer at 3 ms, and stores the time of the wake-up.
  BoardSystem system(R"(
_start: li s0, POWER_MANAGER_BASE
    li s1, TIMER_BASE
    li s2, 0x1C060000
    li a0, 3000000
    sw a0, TIMER_COMPARE_LO_OFFSET(s1)
    sw zero, TIMER_COMPARE_HI_OFFSET(s1)
    li a0, 1 << TIMER_INTERRUPT
    csrw mie, a0
    li a0, 1
    sw a0, POWER_MANAGER_RETENTION_OFFSET(s0)
    wfi
    lw a0, TIMER_TIME_LO_OFFSET(s1)
    sw a0, 0(s2)
    lw a0, POWER_MANAGER_RETENTION_OFFSET(s0)
    sw a0, 4(s2)
1:  j 1b
)");
  system.soc.advance(2'000'000);
  const auto early = system.soc.energy();
  system.soc.advance(2'900'000);
  const auto spent_j = system.soc.energy().total_j() - early.total_j();
  const auto expected_j = 0.9e-3 * 2.311e-6 * (524288 + 16384) / 4096;  // at 0.8 V
  EXPECT_NEAR(spent_j, expected_j, 1e-6 * expected_j) << "difference of two sums, and the gated clock of no core";
  system.soc.advance(6'000'000);
  EXPECT_NEAR(system.result(0), 3'000'000 + 1'200'000, 200) << "ns: the timer, and the wake-up of 1.2 ms";
  EXPECT_EQ(system.result(1), 0U) << "must be requested again";
}

TEST(Retention, IsRefusedWhileTheClusterIsOn) {
  BoardSystem system(R"(
_start: li s0, POWER_MANAGER_BASE
    li s2, 0x1C060000
    la a0, core
    sw a0, POWER_MANAGER_CLUSTER_BOOT_OFFSET(s0)
    li a0, 1
    sw a0, POWER_MANAGER_CLUSTER_POWER_OFFSET(s0)
    sw a0, POWER_MANAGER_RETENTION_OFFSET(s0)
    lw a0, POWER_MANAGER_STATUS_OFFSET(s0)
    sw a0, 0(s2)
1:  j 1b
core: wfi
    j core
)");
  system.soc.advance(10'000);
  EXPECT_EQ(system.result(0), 1U);
}

TEST(Energy, StopsWithTheSupply) {
  BoardSystem system("_start: j _start\n");
  system.soc.advance(1'000'000);
  system.soc.power_off();
  const auto ledger = system.soc.energy();
  const auto camera_j = system.camera_energy_j();
  const auto cycles = system.soc.hart().counters().cycles;
  system.soc.advance(9'000'000);
  EXPECT_EQ(system.soc.energy().total_j(), ledger.total_j());
  EXPECT_EQ(system.camera_energy_j(), camera_j);
  EXPECT_EQ(system.soc.hart().counters().cycles, cycles);
  EXPECT_FALSE(system.soc.running());
}

TEST(ChipFile, ReportsAllMistakes) {
  const auto codes_of = [](const std::string& text) {
    std::vector<std::pair<ErrorCode, std::string>> found;
    try {
      parse_chip(text, "x.json");
    } catch (const data::Mistakes& mistakes) {
      for (const auto& mistake : mistakes.list()) found.emplace_back(mistake.code, mistake.place);
    }
    return found;
  };
  const auto codes = codes_of(R"({"name": "x", "clok": 1,
"core": "z80", "wake_up": {"value": 2, "unit": "s", "source": "x"},
"checks": {"least": {"value": 2, "unit": "1", "source": "x"}, "most": {"value": 1, "unit": "1", "source": "x"}},
"energy": {"instruction": {"unit": "pJ", "source": "", "values": {"warm": {}}}}})");
  EXPECT_THAT(codes, testing::IsSupersetOf({std::pair(ErrorCode::unknown_key, "x.json:1:15: /clok"),
                                            std::pair(ErrorCode::unknown_name, "x.json:2:1: /core"),
                                            std::pair(ErrorCode::value_out_of_range, "x.json:2:28: /wake_up/value"),
                                            std::pair(ErrorCode::invalid_value, "x.json:3:63: /checks/most"),
                                            std::pair(ErrorCode::missing_key, "x.json:3:1: /checks"),
                                            std::pair(ErrorCode::missing_key, "x.json:4:1: /energy")}));
  EXPECT_EQ(codes_of("{").size(), 1U);
}

}  // namespace
}  // namespace mebots::soc::test
