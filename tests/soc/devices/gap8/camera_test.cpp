// SPDX-License-Identifier: Apache-2.0
// Tests the camera of a GAPuino on GAP8's uDMA: a program configures an HM01B0 over I2C and reads it through the camera
// interface, as the driver of GreenWaves' gap_sdk does.
#include "board_system.hpp"
#include "devices/gap8/himax.hpp"
#include "support/same_state.hpp"

#include "mebots/error.hpp"
#include "mebots/state/save.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace mebots::soc::test {
namespace {

using gap8_devices::Himax;

void set(Himax& sensor, std::uint32_t at, std::uint8_t value, Picoseconds now = 0) {
  sensor.start();
  for (const auto byte : {static_cast<std::uint8_t>(at >> 8), static_cast<std::uint8_t>(at), value}) {
    sensor.write(byte, now);
  }
}

std::uint8_t get(Himax& sensor, std::uint32_t at) {
  sensor.start();
  sensor.write(static_cast<std::uint8_t>(at >> 8), 0);
  sensor.write(static_cast<std::uint8_t>(at), 0);
  return sensor.read();
}

/// Returns a picture in which pixel (row, column) has the value row + column.
std::vector<std::uint8_t> picture_of(std::size_t rows) {
  std::vector<std::uint8_t> pixels(rows * Himax::kWidth);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    pixels[i] = static_cast<std::uint8_t>(i / Himax::kWidth + i % Himax::kWidth);
  }
  return pixels;
}

TEST(Gap8Himax, KeepsRegistersUntilItIsReset) {
  Himax sensor;
  EXPECT_EQ(get(sensor, 0x0000), 0x01);
  EXPECT_EQ(get(sensor, 0x0001), 0xB0);
  set(sensor, 0x2101, 0x4E);
  EXPECT_EQ(get(sensor, 0x2101), 0x4E);
  set(sensor, 0x0100, 1);
  EXPECT_TRUE(sensor.streams());
  set(sensor, 0x0103, 1);
  EXPECT_FALSE(sensor.streams());
  EXPECT_EQ(get(sensor, 0x2101), 0);
}

TEST(Gap8Himax, HasTheFrameTimesThatWereMeasuredOnAnAiDeck) {
  Himax sensor;
  // 344 lines of 376 clocks at 6 MHz: 21.6 ms (idsia-robotics/nanocockpit, himax_supported_framerates.md).
  set(sensor, 0x0100, 1, 1'000'000);
  EXPECT_EQ(sensor.frame_at(0), 1'000'000);
  EXPECT_NEAR(static_cast<double>(sensor.frame_at(1'000'001) - 1'000'000), 21.557e9, 1e6);
  // With the window of 244 rows, a frame has 260 lines and takes 16.3 ms.
  set(sensor, 0x3010, 1);
  set(sensor, 0x0340, 1);
  set(sensor, 0x0341, 4);
  EXPECT_NEAR(static_cast<double>(sensor.frame_at(1'000'001) - 1'000'000), 16.293e9, 1e6);
}

TEST(Gap8Himax, ReadsOutTheFirstFrameAfterItsExposure) {
  Himax sensor;
  set(sensor, 0x0203, 100);
  set(sensor, 0x0100, 1, 1000);
  EXPECT_EQ(sensor.frame_at(0), 1000 + sensor.lines_time(100));
}

TEST(Gap8Himax, TakesTheSelectedNumberOfFramesAndEntersStandby) {
  Himax sensor;
  const auto frame = sensor.lines_time(344);
  set(sensor, 0x3020, 2);
  set(sensor, 0x0100, 3, 1000);
  EXPECT_EQ(sensor.frame_at(1000), 1000);
  EXPECT_EQ(sensor.frame_at(1001), 1000 + frame);
  EXPECT_EQ(sensor.frame_at(1001 + frame), kNever);
  EXPECT_EQ(sensor.next_event(), 1000 + 2 * frame);
  sensor.advance(999 + 2 * frame);
  EXPECT_TRUE(sensor.streams());
  sensor.advance(1000 + 2 * frame);
  EXPECT_FALSE(sensor.streams());
  EXPECT_EQ(sensor.next_event(), kNever);
}

TEST(Gap8Himax, CountsFramesFromTheNextOneIfMode3IsSetDuringAFrame) {
  Himax sensor;
  const auto frame = sensor.lines_time(344);
  set(sensor, 0x3020, 1);
  set(sensor, 0x0100, 3, 0);
  set(sensor, 0x0100, 3, frame / 2);
  EXPECT_EQ(sensor.frame_at(1), frame);
  EXPECT_EQ(sensor.next_event(), 2 * frame);
}

void set_pair(Himax& sensor, std::uint32_t at, std::uint32_t value) {
  set(sensor, at, static_cast<std::uint8_t>(value >> 8));
  set(sensor, at + 1, static_cast<std::uint8_t>(value));
}

TEST(Gap8Himax, HasTheHighestRateOfEachFormatOfTheTable) {
  struct Format {
    bool halved;
    bool window;
    std::uint32_t lines;
    std::uint32_t clocks;
    std::uint32_t width;
    std::uint32_t height;
    double rate_hz;
  };
  // The rates are those of the formats 0 to 3 in the column "Max" of himax_supported_framerates.md (repository
  // idsia-robotics/nanocockpit).
  for (const auto& format :
       {Format{false, false, 344, 376, 324, 324, 46.39}, Format{false, true, 260, 376, 324, 244, 61.37},
        Format{true, false, 170, 215, 162, 162, 164.16}, Format{true, true, 128, 215, 162, 122, 218.02}}) {
    Himax sensor;
    set(sensor, 0x0383, format.halved ? 3 : 1);
    set(sensor, 0x0387, format.halved ? 3 : 1);
    set(sensor, 0x3010, format.window ? 1 : 0);
    set_pair(sensor, 0x0340, format.lines);
    set_pair(sensor, 0x0342, format.clocks);
    set(sensor, 0x0100, 1);
    EXPECT_EQ(sensor.format().width(), format.width);
    EXPECT_EQ(sensor.format().height(), format.height);
    EXPECT_NEAR(1e12 / static_cast<double>(sensor.frame_at(1)), format.rate_hz, 0.005);
    set_pair(sensor, 0x0202, 100);
    EXPECT_EQ(sensor.exposure_time(), sensor.lines_time(100));
  }
}

TEST(Gap8Himax, HalvesAPictureByBinningOrSubsampling) {
  Himax sensor;
  const auto picture = picture_of(Himax::kHeight);  // the pixel (row, column) has the value row + column
  std::vector<std::uint8_t> pixels;
  set(sensor, 0x0383, 3);
  set(sensor, 0x0387, 3);
  sensor.format().read_out(picture, pixels);
  ASSERT_EQ(pixels.size(), std::size_t{162} * 162);
  EXPECT_EQ(pixels[0], 0);
  EXPECT_EQ(pixels[162 + 1], 4) << "row 2, column 2";
  set(sensor, 0x0390, 3);
  sensor.format().read_out(picture, pixels);
  EXPECT_EQ(pixels[0], 1) << "mean of 0, 1, 1, 2";
  EXPECT_EQ(pixels[162 + 1], 5);
}

TEST(Gap8Himax, ReadsOutTheWindowMirroredAndUpsideDown) {
  Himax sensor;
  const auto picture = picture_of(Himax::kHeight);
  std::vector<std::uint8_t> pixels;
  sensor.format().read_out(picture, pixels);
  EXPECT_EQ(pixels, picture);
  set(sensor, 0x3010, 1);
  sensor.format().read_out(picture, pixels);
  EXPECT_EQ(pixels.size(), std::size_t{244} * 324);
  EXPECT_EQ(pixels[0], 40) << "40 rows above the window";
  set(sensor, 0x0101, 3);
  sensor.format().read_out(picture, pixels);
  EXPECT_EQ(pixels[0], static_cast<std::uint8_t>(283 + 323));
}

/// Sets the camera to mode 3 with two frames over I2C, reads the mode back, takes a picture into L2, and reports its
/// arrival. The first frame begins before the transfer.
constexpr std::string_view kPictureProgram = R"(
_start: li s0, 0x1A102000
    li s1, 0x1C060000
    li s2, 0x00204000
    li s3, 0x1A106000
    li a0, 0xfffbcfff      # hears events 12, 13 and 18
    sw a0, 0x08(s3)
    li a0, 0x08000000
    sw a0, 0x08(s2)
    la a0, window
    li a1, 23
    call send
    la a0, mode
    li a1, 10
    call send
    la a0, at_mode
    li a1, 8
    call send
    addi a0, s1, 16
    sw a0, 0x300(s0)
    li a0, 1
    sw a0, 0x304(s0)
    li a0, 0x10
    sw a0, 0x308(s0)
    la a0, read
    li a1, 5
    sw a0, 0x310(s0)
    sw a1, 0x314(s0)
    li a0, 0x10
    sw a0, 0x318(s0)
    call wait
    sw a3, 0(s1)
    call wait
    sw a3, 4(s1)
    li a0, 0x1C040000
    sw a0, 0x480(s0)
    li a0, 324 * 244
    sw a0, 0x484(s0)
    li a0, 0x12
    sw a0, 0x488(s0)
    li a0, 0x80000500      # on, bytes in their order
    sw a0, 0x4a0(s0)
    call wait
    sw a3, 8(s1)
1:  .insn i 0x03, 6, a4, 0x38(s2)
    j 1b
send: mv s4, ra
    sw a0, 0x310(s0)
    sw a1, 0x314(s0)
    li a0, 0x10
    sw a0, 0x318(s0)
    call wait
    jr s4
wait: .insn i 0x03, 6, a4, 0x38(s2)
    li a3, 0x00200800
    lw a3, 0x700(a3)
    li a4, 0x08000000
    sw a4, 0x28(s2)
    ret
window: .byte 0xE0, 0, 100, 0x00, 0x80, 0x48, 0xC0, 3, 0x80, 0x30, 0x10, 1, 0x20
        .byte 0x00, 0x80, 0x48, 0xC0, 3, 0x80, 0x30, 0x20, 2, 0x20
mode: .byte 0x00, 0x80, 0x48, 0xC0, 3, 0x80, 0x01, 0x00, MODE, 0x20
at_mode: .byte 0x00, 0x80, 0x48, 0xC0, 2, 0x80, 0x01, 0x00
read: .byte 0x00, 0x80, 0x49, 0x60, 0x20
    .org 0x800             # for the tests to send, 10 bytes each
        .byte 0x00, 0x80, 0x48, 0xC0, 3, 0x80, 0x30, 0x10, 0, 0x20
        .byte 0x00, 0x80, 0x48, 0xC0, 3, 0x80, 0x01, 0x03, 1, 0x20
        .byte 0x00, 0x80, 0x48, 0xC0, 3, 0x80, 0x01, 0x00, 0, 0x20
        .byte 0x00, 0x80, 0x48, 0xC0, 3, 0x80, 0x01, 0x00, 1, 0x20
)";
constexpr std::uint32_t kAllRows = kL2 + 0x800;
constexpr std::uint32_t kReset = kAllRows + 10;
constexpr std::uint32_t kStandBy = kReset + 10;
constexpr std::uint32_t kStream = kStandBy + 10;

std::string takes_a_picture(int mode = 1) {
  return fmt::format("#define MODE {}\n{}", mode, kPictureProgram);
}

BoardDescription gap8_board_of_camera() {
  return read_board(MEBOTS_SOURCE_DIR "/configs/boards/gap8.json");
}

Settings with_pictures(std::size_t count) {
  Settings settings;
  settings.pictures.assign(count, picture_of(Himax::kWindowHeight));
  return settings;
}

TEST(Gap8Camera, DeliversThePictureOfTheRollAfterReadOut) {
  BoardSystem system(takes_a_picture(), with_pictures(1), gap8_board_of_camera());
  system.soc.advance(15 * kMs);
  EXPECT_TRUE(system.faults.empty()) << system.faults.front();
  EXPECT_EQ(system.result(4) & 0xffU, 1U) << "the mode, read back";
  EXPECT_EQ(system.result(0) | system.result(1), 0x80000000U | 12U | 13U) << "both channels of the bus";
  EXPECT_EQ(system.result(2), 0U) << "244 lines of 376 clocks at 6 MHz are 15.3 ms, from the next frame on";
  system.soc.advance(60 * kMs);
  EXPECT_EQ(system.result(2), 0x80000000U | 18U);
  const auto picture = picture_of(Himax::kWindowHeight);
  std::vector<std::uint8_t> taken(picture.size());
  ASSERT_TRUE(system.soc.memory().read(0x1C040000, taken));
  EXPECT_EQ(taken, picture);
}

/// Provides the world's picture for the pending request.
void give(BoardSystem& system, const std::vector<std::uint8_t>& picture) {
  *system.soc.devices().input("camera.frame_id") = system.output("camera.trigger");
  *system.soc.devices().find("udma")->bytes_input("camera.frame") = picture;
  system.soc.begin_step();
}

TEST(Gap8Camera, RequestsThePictureAtTheStartOfTheFrameAndStoresItWithTheLastRow) {
  BoardSystem system(takes_a_picture(), {}, gap8_board_of_camera());
  *system.soc.devices().input("camera.frame_height") = Himax::kWindowHeight;
  system.soc.advance(15 * kMs);
  EXPECT_EQ(system.output("camera.trigger"), 0) << "the frame under way had begun before the transfer";
  EXPECT_TRUE(system.soc.devices().wait_for_picture());
  system.soc.advance(24 * kMs);
  ASSERT_EQ(system.output("camera.trigger"), 1) << "344 lines after the first one";
  const auto picture = picture_of(Himax::kWindowHeight);
  give(system, picture);
  system.soc.advance(36 * kMs);
  EXPECT_EQ(system.result(2), 0U);
  system.soc.advance(40 * kMs);
  EXPECT_EQ(system.result(2), 0x80000000U | 18U) << "244 lines are 15.3 ms, whenever the picture came";
  std::vector<std::uint8_t> taken(picture.size());
  ASSERT_TRUE(system.soc.memory().read(0x1C040000, taken));
  EXPECT_EQ(taken, picture);
}

class Gap8CameraInMode : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Modes, Gap8CameraInMode, testing::Values(1, 3));

TEST_P(Gap8CameraInMode, StoresALatePictureAtItsArrival) {
  BoardSystem system(takes_a_picture(GetParam()), {}, gap8_board_of_camera());
  *system.soc.devices().input("camera.frame_height") = 0;
  system.soc.advance(90 * kMs);
  EXPECT_EQ(system.result(2), 0U);
  give(system, picture_of(Himax::kWindowHeight));
  system.soc.advance(91 * kMs);
  EXPECT_EQ(system.result(2), 0x80000000U | 18U);
}

void store(BoardSystem& system, std::uint32_t offset, std::uint32_t value, std::int64_t now_ns) {
  system.soc.devices().find("udma")->store(offset, now_ns * 1000, value);
}

/// Writes to the sensor through the other I2C master, whose event the program does not handle.
void write_sensor(BoardSystem& system, std::uint32_t commands, std::int64_t now_ns, std::uint32_t bytes = 10) {
  store(system, 0x290, commands, now_ns);
  store(system, 0x294, bytes, now_ns);
  store(system, 0x298, 0x10, now_ns);
}

void expect_row_is_missed(BoardSystem& system) {
  try {
    system.soc.advance(70 * kMs);
    FAIL() << "stored";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("at present at least 324 rows"));
  }
}

/// A system in the middle of the frame of a requested transfer.
struct InItsFrame : BoardSystem {
  InItsFrame() : BoardSystem(takes_a_picture(), {}, gap8_board_of_camera()) {
    *soc.devices().input("camera.frame_height") = Himax::kWindowHeight;
    soc.advance(24 * kMs);
    EXPECT_EQ(output("camera.trigger"), 1);
  }
};

std::vector<std::uint8_t> stored_by(const BoardSystem& system) {
  std::vector<std::uint8_t> taken(picture_of(Himax::kWindowHeight).size());
  EXPECT_TRUE(system.soc.memory().read(0x1C040000, taken));
  return taken;
}

/// Returns a black picture.
std::vector<std::uint8_t> night() {
  return std::vector<std::uint8_t>(picture_of(Himax::kWindowHeight).size());
}

class Gap8CameraCommand : public testing::TestWithParam<std::uint32_t> {};
INSTANTIATE_TEST_SUITE_P(Commands, Gap8CameraCommand, testing::Values(kAllRows, kReset, kStandBy));

TEST_P(Gap8CameraCommand, StoresALateFrameWithTheSensorsSettingsOfItsReadOut) {
  InItsFrame system;
  system.soc.advance(60 * kMs);
  write_sensor(system, GetParam(), 60 * kMs);
  system.soc.advance(61 * kMs);
  give(system, picture_of(Himax::kWindowHeight));
  system.soc.advance(62 * kMs);
  EXPECT_EQ(system.result(2), 0x80000000U | 18U);
  EXPECT_EQ(stored_by(system), picture_of(Himax::kWindowHeight));
}

/// Returns the bytes that are stored for one picture. The camera interface passes only a window of the picture,
/// converts it to RGB565, and weights it by its filter. If `cleared_behind_it` is the offset of a register, clears this
/// register after the window's last row.
std::vector<std::uint8_t> stored_frame_of_a_window(std::optional<std::uint32_t> cleared_behind_it) {
  BoardSystem system(takes_a_picture(), {}, gap8_board_of_camera());
  *system.soc.devices().input("camera.frame_height") = Himax::kWindowHeight;
  system.soc.advance(15 * kMs);
  store(system, 0x4a4, 0x00020003, 15 * kMs);
  store(system, 0x4a8, 0x00f00050, 15 * kMs);
  store(system, 0x4b0, 0x00010203, 15 * kMs);
  store(system, 0x4a0, 0x80000880, 15 * kMs);
  system.soc.advance(24 * kMs);
  EXPECT_EQ(system.output("camera.trigger"), 1);
  if (cleared_behind_it) {
    system.soc.advance(60 * kMs);
    store(system, *cleared_behind_it, 0, 60 * kMs);
    system.soc.advance(61 * kMs);
  }
  give(system, picture_of(Himax::kWindowHeight));
  system.soc.advance(62 * kMs);
  EXPECT_EQ(system.result(2), 0x80000000U | 18U);
  return stored_by(system);
}

class Gap8CameraInterface : public testing::TestWithParam<std::uint32_t> {};
INSTANTIATE_TEST_SUITE_P(Registers, Gap8CameraInterface, testing::Values(0x4a0, 0x4a4, 0x4a8, 0x4b0));

TEST_P(Gap8CameraInterface, StoresALateFrameWithTheInterfacesSettingsOfItsReadOut) {
  EXPECT_EQ(stored_frame_of_a_window(GetParam()), stored_frame_of_a_window(std::nullopt));
}

TEST(Gap8Camera, ReadsAFrameOutInTheFormatWithWhichItBegan) {
  InItsFrame system;
  write_sensor(system, kAllRows, 24 * kMs);
  give(system, picture_of(Himax::kWindowHeight));
  system.soc.advance(40 * kMs);
  EXPECT_EQ(system.result(2), 0x80000000U | 18U);
  EXPECT_EQ(stored_by(system), picture_of(Himax::kWindowHeight));
}

/// Time at which the picture arrives, relative to the standby.
enum class Comes : std::uint8_t { before, behind, never };
class Gap8CameraStandingBy : public testing::TestWithParam<std::tuple<Comes, std::uint32_t>> {};
INSTANTIATE_TEST_SUITE_P(Pictures, Gap8CameraStandingBy,
                         testing::Combine(testing::Values(Comes::before, Comes::behind, Comes::never),
                                          testing::Values(kStandBy, kReset)));

TEST_P(Gap8CameraStandingBy, LosesTheFrameInProgressAndTakesTheNextOne) {
  const auto [comes, command] = GetParam();
  InItsFrame system;
  if (comes == Comes::before) give(system, night());
  write_sensor(system, command, 25 * kMs);
  system.soc.advance(26 * kMs);
  if (comes == Comes::behind) give(system, night());
  system.soc.advance(90 * kMs);
  EXPECT_EQ(system.result(2), 0U);
  write_sensor(system, kStream, 90 * kMs);
  system.soc.advance(91 * kMs);
  EXPECT_EQ(system.output("camera.trigger"), 2) << "another frame, another picture";
  *system.soc.devices().input("camera.frame_height") = 0;
  give(system, picture_of(Himax::kHeight));
  system.soc.advance(120 * kMs);
  EXPECT_EQ(system.result(2), 0x80000000U | 18U);
  EXPECT_EQ(stored_by(system)[0], command == kReset ? 0 : 40) << "of all rows, or of the window";
}

TEST(Gap8Camera, LosesTheFrameInProgressAlsoIfOneTransferWakesIt) {
  InItsFrame system;
  give(system, night());
  write_sensor(system, kStandBy, 30 * kMs, 20);
  system.soc.advance(40 * kMs);
  EXPECT_EQ(system.output("camera.trigger"), 2);
  EXPECT_EQ(system.result(2), 0U);
  give(system, picture_of(Himax::kWindowHeight));
  system.soc.advance(50 * kMs);
  EXPECT_EQ(system.result(2), 0x80000000U | 18U);
  EXPECT_EQ(stored_by(system), picture_of(Himax::kWindowHeight));
}

TEST(Gap8Camera, IgnoresThePictureOfAClearedTransfer) {
  InItsFrame system;
  store(system, 0x488, 0x30, 25 * kMs);
  *system.soc.devices().input("camera.frame_id") = 1;
  const auto dark = night();
  *system.soc.devices().find("udma")->bytes_input("camera.frame") = dark;
  system.soc.begin_step();
  system.soc.advance(46 * kMs);
  system.soc.begin_step();
  ASSERT_EQ(system.output("camera.trigger"), 2) << "of the next frame";
  give(system, picture_of(Himax::kWindowHeight));
  system.soc.advance(70 * kMs);
  EXPECT_EQ(system.result(2), 0x80000000U | 18U);
  EXPECT_EQ(stored_by(system), picture_of(Himax::kWindowHeight));
}

TEST(Gap8Camera, RefusesAPictureWithFewerRowsAfterAClearedTransfer) {
  BoardSystem system(takes_a_picture(), with_pictures(1), gap8_board_of_camera());
  system.soc.advance(24 * kMs);
  write_sensor(system, kAllRows, 24 * kMs);
  store(system, 0x488, 0x30, 24 * kMs);
  expect_row_is_missed(system);
}

TEST(Gap8Camera, RefusesAPictureOfAnotherSize) {
  BoardSystem system(takes_a_picture(), {}, gap8_board_of_camera());
  system.soc.advance(24 * kMs);
  try {
    give(system, picture_of(648));
    FAIL() << "taken";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(
                                  "has 209952 bytes, but camera.frame_width and camera.frame_height demand 324 x 324"));
  }
}

TEST(Gap8Camera, RefusesParametersThatDoNotFitTheSensorAtTheStart) {
  struct Size {
    double width;
    double height;
    bool good;
  };
  for (const auto& [width, height, good] : {Size{324, 324, true}, Size{324, 244, true}, Size{324, 0, true},
                                            Size{648, 162, false}, Size{648, 0, false}, Size{324, 243, false}}) {
    BoardSystem system(takes_a_picture(), {}, gap8_board_of_camera());
    *system.soc.devices().input("camera.frame_width") = width;
    *system.soc.devices().input("camera.frame_height") = height;
    if (good) {
      EXPECT_NO_THROW(system.soc.begin_step()) << width << " x " << height;
    } else {
      EXPECT_THROW(system.soc.begin_step(), Error) << width << " x " << height;
    }
  }
}

TEST(Gap8Camera, WaitsAfterTheLastPictureOfTheRoll) {
  Settings settings = with_pictures(1);
  settings.pictures.front().clear();
  BoardSystem system(takes_a_picture(), settings, gap8_board_of_camera());
  system.soc.advance(60 * kMs);
  EXPECT_EQ(system.result(2), 0U);
  EXPECT_TRUE(system.soc.devices().wait_for_picture());
}

/// Calls `scenario` after each millisecond of 70 ms. All runs must be equal, also if another system continues from a
/// saved state.
template <typename Scenario>
void expect_same_run_from_states(const Settings& settings, int mode, const Scenario& scenario) {
  const auto run = [&](std::int64_t saved_at_ms) {
    auto system = std::make_unique<BoardSystem>(takes_a_picture(mode), settings, gap8_board_of_camera());
    *system->soc.devices().input("camera.frame_height") = Himax::kWindowHeight;
    for (std::int64_t ms = 1; ms <= 70; ++ms) {
      system->soc.advance(ms * kMs);
      if (ms == saved_at_ms) {
        auto other = std::make_unique<BoardSystem>(takes_a_picture(mode), settings, gap8_board_of_camera());
        state::restore(other->soc, state::save(system->soc));
        system = std::move(other);
      }
      scenario(*system, ms);
    }
    return system;
  };
  const auto straight = run(0);
  for (const std::int64_t saved_at_ms : {1, 10, 15, 24, 25, 30, 39, 46, 60}) {
    EXPECT_TRUE(mebots::test::same_state(run(saved_at_ms)->soc, straight->soc)) << saved_at_ms << " ms";
  }
}

TEST_P(Gap8CameraInMode, ContinuesFromAStateWithPicturesOfARoll) {
  expect_same_run_from_states(with_pictures(1), GetParam(), [](BoardSystem&, std::int64_t) {});
}

TEST_P(Gap8CameraInMode, ContinuesFromAStateWithPicturesOfAWorld) {
  const auto picture = picture_of(Himax::kWindowHeight);
  expect_same_run_from_states({}, GetParam(), [&](BoardSystem& system, std::int64_t ms) {
    if (ms == 30) give(system, picture);
    if (ms == 60) {
      EXPECT_EQ(system.result(2), 0x80000000U | 18U);
    }
  });
}

TEST_P(Gap8CameraInMode, ContinuesFromAStateBetweenAFrameAndItsLatePicture) {
  const auto picture = picture_of(Himax::kWindowHeight);
  expect_same_run_from_states({}, GetParam(), [&](BoardSystem& system, std::int64_t ms) {
    if (ms == 45) store(system, 0x4a0, 0, ms * kMs);
    if (ms == 50) give(system, picture);
    if (ms == 60) {
      EXPECT_EQ(system.result(2), 0x80000000U | 18U);
      EXPECT_EQ(stored_by(system), picture);
    }
  });
}

TEST_P(Gap8CameraInMode, ContinuesFromAStateBeforeAndAfterAClearedTransfer) {
  const auto picture = picture_of(Himax::kWindowHeight);
  expect_same_run_from_states({}, GetParam(), [&](BoardSystem& system, std::int64_t ms) {
    if (ms == 25) give(system, picture);
    if (ms == 30) store(system, 0x488, 0x30, ms * kMs);
    if (ms == 40) write_sensor(system, kStream, ms * kMs);  // at this time, the frames of mode 3 are complete
    if (ms == 50) {
      EXPECT_EQ(system.output("camera.trigger"), 2);
    }
    if (ms == 50) give(system, picture);
    if (ms == 70) {
      EXPECT_EQ(system.result(2), 0x80000000U | 18U);
    }
  });
}

}  // namespace
}  // namespace mebots::soc::test
