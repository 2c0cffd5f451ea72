// SPDX-License-Identifier: Apache-2.0
// Tests the energy of memories, pads, camera and regulators outside the chip.
#include "devices/core/attached_part.hpp"
#include "board_system.hpp"
#include "devices/gap8/himax.hpp"
#include "support/same_state.hpp"

#include "mebots/error.hpp"
#include "mebots/state/save.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

namespace mebots::soc::test {
namespace {

using testing::HasSubstr;

constexpr double kSumRounding = 1e-12;  // relative tolerance for sums of doubles
constexpr double kVolt = 2;
constexpr double kIdleA = 1e-3;
constexpr double kActiveA = 5e-3;
constexpr double kPerByteC = 1e-9;

BoardDevice memory_part() {
  BoardDevice entry;
  entry.name = "ram";
  entry.kind = "part";
  entry.supply_voltage_v = kVolt;
  entry.states = {{"active", kActiveA, 0, {}, {}}, {"idle", kIdleA, 0, {}, {}}};
  entry.initial_state = "idle";
  entry.part = {"bus.ram", kPerByteC};
  return entry;
}

TEST(BoardPart, ConsumesByStateTimeAndBytes) {
  const auto entry = memory_part();
  AttachedPart part(entry);
  PartPort port(&part);
  EXPECT_EQ(part.state_name(), "idle");
  port.begin(2'000'000'000);
  EXPECT_EQ(part.state_name(), "active");
  port.end(5'000'000'000, 1000);
  const auto expected_j = kVolt * (kIdleA * 9e-3 + kActiveA * 3e-3 + kPerByteC * 1000);
  EXPECT_NEAR(part.energy_j(12'000'000'000), expected_j, kSumRounding * expected_j);
}

TEST(BoardPart, ConsumesByBytesOnlyIfItHasNoStates) {
  auto entry = memory_part();
  entry.states.clear();
  entry.initial_state.clear();
  AttachedPart part(entry);
  PartPort port(&part);
  port.begin(1'000'000);
  port.end(2'000'000, 7);
  EXPECT_DOUBLE_EQ(part.energy_j(1'000'000'000), kVolt * kPerByteC * 7);
  EXPECT_TRUE(part.state_name().empty());
}

TEST(BoardPart, RequiresTheStatesOfItsPlace) {
  auto entry = memory_part();
  entry.states[0].name = "busy";
  AttachedPart part(entry);
  EXPECT_THAT([&] { PartPort{&part}; }, testing::ThrowsMessage<Error>(HasSubstr("needs a state \"active\"")));
}

TEST(BoardPart, CameraIsActiveWhileItStreams) {
  const auto entry = memory_part();
  AttachedPart part(entry);
  gap8_devices::Himax sensor{PartPort(&part)};
  const auto set = [&](std::uint8_t at, std::uint8_t value, Picoseconds now) {
    sensor.start();
    for (const auto byte : {std::uint8_t{0x01}, at, value}) sensor.write(byte, now);
  };
  set(0x00, 1, 1'000'000'000);
  set(0x00, 1, 2'000'000'000);
  set(0x03, 1, 4'000'000'000);  // a reset of the sensor ends its sleep
  const auto expected_j = kVolt * (kActiveA * 3e-3 + kIdleA * 7e-3);
  EXPECT_NEAR(part.energy_j(10'000'000'000), expected_j, kSumRounding * expected_j);
}

/// The program reads 4096 bytes from the HyperRAM and 4096 bytes from the flash. It cancels a third transfer after its
/// start.
constexpr auto kMoves = R"(
_start: li s0, 0x1A102180
    li s1, 0x1C060000
    li s5, 4096
    li a0, 0x1000
    call fetch
    li a0, 0x01000000
    call fetch
    li a0, 0x1000
    sw a0, 0x20(s0)
    li a0, 0x10
    sw a0, 8(s0)
    li a0, 0x20
    sw a0, 8(s0)
1:  j 1b
fetch: sw a0, 0x20(s0)
    sw s1, 0(s0)
    sw s5, 4(s0)
    li a0, 0x10
    sw a0, 8(s0)
2:  lw a0, 8(s0)
    andi a0, a0, 0x10
    bnez a0, 2b
    ret
)";

BoardSystem moving() {
  return BoardSystem(kMoves, {}, read_board(MEBOTS_SOURCE_DIR "/configs/boards/gap8.json"));
}

double joules_of(const BoardSystem& system, std::string_view name) {
  return system.soc.power().energy_j(*system.soc.devices().find(name));
}

TEST(BoardPart, ConsumesByBytesOnTheHyperBusOfGap8) {
  auto system = moving();
  system.soc.advance(2 * kMs);
  ASSERT_TRUE(system.faults.empty()) << system.faults.front();
  const auto& board = system.soc.board();
  const auto entry = [&](std::string_view name) -> const BoardDevice& {
    return *std::ranges::find(board.devices, name, &BoardDevice::name);
  };
  const auto& ram = entry("hyperram");
  const auto ram_j = ram.supply_voltage_v * (ram.state("idle").current_a * 2e-3 + ram.part->charge_per_byte * 4096);
  EXPECT_NEAR(joules_of(system, "hyperram"), ram_j, kSumRounding * ram_j) << "the transfer given up counts no bytes";
  const auto& pads = entry("pads");
  const auto pads_j = pads.supply_voltage_v * pads.part->charge_per_byte * 8192;
  EXPECT_NEAR(joules_of(system, "pads"), pads_j, kSumRounding * pads_j);
  // The clock after reset is 1525 * 32768 Hz, and that of the flash is half of it.
  const auto& flash = entry("hyperflash");
  const auto active_s = (15 + 4096 / 2) * 2 / (1525 * 32768.0);
  const auto flash_j =
      flash.supply_voltage_v * (flash.state("idle").current_a * (2e-3 - active_s) +
                                flash.state("active").current_a * active_s + flash.part->charge_per_byte * 4096);
  EXPECT_NEAR(joules_of(system, "hyperflash"), flash_j, 1e-9 * flash_j) << "whole picoseconds";
}

TEST(BoardPart, RegulatorsTakeTheirLoadsEnergyOverTheirEfficiency) {
  auto system = moving();
  system.soc.advance(2 * kMs);
  const auto loads_j = system.soc.energy().total_j() + joules_of(system, "hyperram") + joules_of(system, "hyperflash") +
                       joules_of(system, "pads") + joules_of(system, "camera");
  EXPECT_NEAR(joules_of(system, "rails"), loads_j, kSumRounding * loads_j);
  const auto board = read_board(MEBOTS_SOURCE_DIR "/configs/boards/gap8.json");
  const auto efficiency = std::ranges::find(board.devices, "board", &BoardDevice::name)->regulator->efficiency;
  EXPECT_LT(efficiency, 1);
  EXPECT_NEAR(joules_of(system, "board"), loads_j / efficiency, kSumRounding * loads_j);
}

TEST(BoardPart, EnergyDoesNotDependOnReadsAndStopsWithTheSupply) {
  auto straight = moving();
  auto looked_at = moving();
  straight.soc.advance(2 * kMs);
  for (std::int64_t time_ns = 1000; time_ns <= 2 * kMs; time_ns += 1000) {
    looked_at.soc.advance(time_ns);
    joules_of(looked_at, "board");
  }
  for (const auto* name : {"hyperram", "hyperflash", "pads", "camera", "board"}) {
    EXPECT_EQ(joules_of(straight, name), joules_of(looked_at, name)) << name;
  }
  straight.soc.power_off();
  const auto before_j = joules_of(straight, "board");
  straight.soc.advance(3 * kMs);
  EXPECT_EQ(joules_of(straight, "board"), before_j);
}

TEST(BoardPart, ContinuesFromAStateWithTheSameBits) {
  auto straight = moving();
  auto first = moving();
  auto second = moving();
  straight.soc.advance(2 * kMs);
  first.soc.advance(50'000);  // in the middle of a transfer
  ASSERT_EQ(dynamic_cast<AttachedPart&>(*first.soc.devices().find("hyperram")).state_name(), "active");
  state::restore(second.soc, state::save(first.soc));
  second.soc.advance(2 * kMs);
  EXPECT_TRUE(mebots::test::same_state(straight.soc, second.soc));
  EXPECT_EQ(joules_of(straight, "board"), joules_of(second, "board"));
}

/// Returns the error of board gap8 after `change`.
std::string complaint_with(void (*change)(BoardDescription&)) {
  auto board = read_board(MEBOTS_SOURCE_DIR "/configs/boards/gap8.json");
  change(board);
  try {
    BoardSystem("_start: j _start\n", {}, board);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(BoardPart, IsRefusedIfNoDeviceHasItsPlace) {
  EXPECT_EQ(complaint_with([](BoardDescription&) {}), "");
  EXPECT_THAT(complaint_with([](BoardDescription& board) {
                std::ranges::find(board.devices, "pads", &BoardDevice::name)->part->attached_to = "udma.hyper_pad";
              }),
              HasSubstr("part pads: attached_to \"udma.hyper_pad\": no device has such a place"));
  EXPECT_THAT(complaint_with([](BoardDescription& board) {
                std::ranges::find(board.devices, "pads", &BoardDevice::name)->part->attached_to = "udma.hyper_ram";
              }),
              HasSubstr("another part is attached there"));
}

}  // namespace
}  // namespace mebots::soc::test
