// SPDX-License-Identifier: Apache-2.0
// The skeleton that mebots-boardgen writes of a device (generated/range_finder.hpp), compiled and in a chip: it is a
// device that lacks only what it does by itself.
#include "skeleton.hpp"
#include "board_system.hpp"
#include "range_finder.hpp"

#include "mebots/state/save.hpp"
#include "mebots/text_file.hpp"

#include <gtest/gtest.h>

namespace mebots::soc::test {
namespace {

/// The board of the time-of-flight example, whose sensor is not described wholly any more.
BoardDescription board_without_initial_state() {
  auto board = read_board(MEBOTS_SOURCE_DIR "/examples/time_of_flight/board.json");
  board.devices.back().initial_state.clear();
  return board;
}

std::unique_ptr<OwnDevice> make(const BoardDevice& entry) {
  return entry.name == "range_finder" ? std::make_unique<RangeFinder>(entry) : nullptr;
}

constexpr std::string_view kMeasure = R"(
_start: li s0, 0x1A108000
    li s1, 0x1C060000
    li a0, 1
    sw a0, 0(s0)
    li a0, 321
    sw a0, 12(s0)
    lw a1, 12(s0)
    sw a1, 0(s1)
1:  wfi
    j 1b
)";

TEST(Skeleton, ObeysOpcodesKeepsRegistersAndSpendsItsEnergy) {
  Settings settings;
  settings.make_device = make;
  BoardSystem system(BoardSystem::assembled(kMeasure), settings, board_without_initial_state());
  auto& soc = system.soc;
  soc.advance(10'000'000);
  EXPECT_EQ(system.result(0), 321U);
  ASSERT_EQ(soc.device_states().size(), 1U);
  EXPECT_EQ(soc.device_states()[0].state, "ranging");
  soc.advance(100'000'000);
  EXPECT_EQ(soc.device_states()[0].state, "standby");
  const auto* sensor = soc.own_device("range_finder");
  ASSERT_NE(sensor, nullptr);
  // 33 ms at 16 mA, the rest at 6 uA, 2.8 V.
  EXPECT_NEAR(soc.energy_j(*sensor), 2.8 * (16e-3 * 0.033 + 6e-6 * 0.067), 1e-12);
  EXPECT_TRUE(soc.set_sensed("range_finder.distance", 2));
  EXPECT_EQ(sensor->sent("range_finder.reported"), 0.321);

  BoardSystem other(BoardSystem::assembled(kMeasure), settings, board_without_initial_state());
  state::restore(other.soc, state::save(soc));
  EXPECT_EQ(other.soc.energy_j(*other.soc.own_device("range_finder")), soc.energy_j(*sensor));
}

TEST(Skeleton, IsNeededForADeviceThatNothingDescribes) {
  EXPECT_THROW(BoardSystem(BoardSystem::assembled(kMeasure), {}, board_without_initial_state()), Error);
}

TEST(Skeleton, RefusesRegistersAndVariablesThatWouldBeOneMember) {
  const auto board = board_without_initial_state();
  for (const auto& name : {"STATE", "SINCE", "RANGE_FINDER_DISTANCE"}) {
    auto device = board.devices.back();
    device.registers.front().name = name;
    EXPECT_THROW(boardgen::skeleton(board, device), Error) << name;
  }
  EXPECT_NO_THROW(boardgen::skeleton(board, board.devices.back()));
}

}  // namespace
}  // namespace mebots::soc::test
