// SPDX-License-Identifier: Apache-2.0
// Tests the skeleton that mebots-boardgen generates for a device, compiled as a library and used in a chip. Only the
// device's behaviour is missing.
#include "board_system.hpp"
#include "headers.hpp"

#include "mebots/state/save.hpp"
#include "mebots/text_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mebots::soc::test {
namespace {

/// Returns the board of the time-of-flight example. The sensor has the kind that skeleton.so implements.
BoardDescription board_with_kind() {
  auto board = read_board(MEBOTS_SOURCE_DIR "/examples/time_of_flight/board.json");
  board.devices.back().kind = "range_finder";
  board.libraries = {"skeleton.so"};
  return board;
}

Settings with_library() {
  Settings settings;
  settings.library_folders = {MEBOTS_BINARY_DIR "/devices"};
  return settings;
}

constexpr std::string_view kMeasure = R"(
_start: li s0, 0x1A188000
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

TEST(Skeleton, ImplementsOpcodesRegistersAndEnergy) {
  BoardSystem system(BoardSystem::assembled(kMeasure), with_library(), board_with_kind());
  auto& soc = system.soc;
  soc.advance(10'000'000);
  EXPECT_EQ(system.result(0), 321U);
  ASSERT_EQ(soc.devices().states().size(), 1U);
  EXPECT_EQ(soc.devices().states()[0].state, "ranging");
  soc.advance(100'000'000);
  EXPECT_EQ(soc.devices().states()[0].state, "standby");
  const auto* sensor = soc.devices().find("range_finder");
  ASSERT_NE(sensor, nullptr);
  // At 2.8 V, the sensor takes 16 mA for 33 ms, and 6 uA for the remaining time.
  EXPECT_NEAR(soc.power().energy_j(*sensor), 2.8 * (16e-3 * 0.033 + 6e-6 * 0.067), 1e-12);
  ASSERT_NE(soc.devices().input("range_finder.distance"), nullptr);
  EXPECT_EQ(*soc.devices().output("range_finder.reported"), 0.321);

  BoardSystem other(BoardSystem::assembled(kMeasure), with_library(), board_with_kind());
  state::restore(other.soc, state::save(soc));
  EXPECT_EQ(other.soc.power().energy_j(*other.soc.devices().find("range_finder")), soc.power().energy_j(*sensor));
}

TEST(Skeleton, IsNeededForADeviceWithoutADescription) {
  auto board = board_with_kind();
  board.libraries.clear();
  EXPECT_THROW(BoardSystem(BoardSystem::assembled(kMeasure), with_library(), board), Error);
}

TEST(KindLibrary, IsRefusedIfItIsNotALibraryOfKinds) {
  auto board = board_with_kind();
  const auto complaint = [&] {
    try {
      const BoardSystem system(BoardSystem::assembled(kMeasure), with_library(), board);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(complaint(), "");
  board.libraries = {"skeleton.so", "skeleton.so"};
  EXPECT_THAT(complaint(), testing::HasSubstr("there is a kind 'range_finder' already"));
  board.libraries = {"board.json"};
  EXPECT_THAT(complaint(), testing::HasSubstr("board.json: cannot be opened as a library of devices"));
}

TEST(Skeleton, RefusesRegistersAndVariablesThatShareAMember) {
  const auto board = board_with_kind();
  for (const auto& name : {"STATE", "SINCE", "RANGE_FINDER_DISTANCE"}) {
    auto device = board.devices.back();
    device.registers.front().name = name;
    EXPECT_THROW(boardgen::skeleton(board, device), Error) << name;
  }
  EXPECT_NO_THROW(boardgen::skeleton(board, board.devices.back()));
}

}  // namespace
}  // namespace mebots::soc::test
