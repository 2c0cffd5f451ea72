// SPDX-License-Identifier: Apache-2.0
#include "board_system.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

namespace mebots::soc::test {
namespace {

constexpr std::int64_t kDelayNs = 16'666'700;  // sum of exposure and read-out in the board file

/// Immediately requests a picture of at most {} bytes, writes {} to CONTROL, and sleeps. The interrupt handler stores
/// STATUS, width, height, id and time.
constexpr std::string_view kAsk = R"(
_start: la t0, handler
    csrw mtvec, t0
    li s0, CAMERA_BASE
    li s1, 0x1C060000
    li a0, 0x1C040000
    sw a0, CAMERA_BUFFER_OFFSET(s0)
    li a0, {}
    sw a0, CAMERA_BUFFER_SIZE_OFFSET(s0)
    li a0, 1 << CAMERA_INTERRUPT
    csrw mie, a0
    csrwi mstatus, 8
    li a0, 1
    sw a0, CAMERA_CONTROL_OFFSET(s0)
    lw a0, CAMERA_STATUS_OFFSET(s0)
    sw a0, 0(s1)
    li a0, {}
    sw a0, CAMERA_CONTROL_OFFSET(s0)
    lw a0, CAMERA_STATUS_OFFSET(s0)
    sw a0, 4(s1)
1:  wfi
    j 1b
    .balign 4
handler: lw a0, CAMERA_STATUS_OFFSET(s0)
    sw a0, 8(s1)
    lw a0, CAMERA_WIDTH_OFFSET(s0)
    sw a0, 12(s1)
    lw a0, CAMERA_HEIGHT_OFFSET(s0)
    sw a0, 16(s1)
    lw a0, CAMERA_FRAME_ID_OFFSET(s0)
    sw a0, 20(s1)
    li s2, TIMER_BASE
    lw a0, TIMER_TIME_LO_OFFSET(s2)
    sw a0, 24(s1)
    li a0, 6
    sw a0, CAMERA_STATUS_OFFSET(s0)
    lw a0, 28(s1)
    addi a0, a0, 1
    sw a0, 28(s1)
    mret
)";

std::vector<std::uint8_t> picture(std::size_t size) {
  std::vector<std::uint8_t> bytes(size);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{3});
  return bytes;
}

TEST(Camera, StoresThePictureAfterTheDelayAndRaisesItsInterruptOnce) {
  BoardSystem system(fmt::format(fmt::runtime(kAsk), 4096, 0), {}, BoardSystem::narrow());
  auto& camera = system.camera();
  EXPECT_FALSE(camera.wants(0)) << "no request";
  system.soc.advance(2 * kMs);
  EXPECT_EQ(camera.requests(), 1);
  EXPECT_EQ(system.result(0), Camera::kBusy);
  EXPECT_FALSE(camera.wants(0));
  EXPECT_TRUE(camera.wants(1));
  const auto bytes = picture(64 * 40);
  camera.offer(bytes, system.soc.now());
  EXPECT_FALSE(camera.wants(1)) << "taken once";
  system.soc.advance(2 * kMs + kDelayNs - 1);
  EXPECT_EQ(system.result(2), 0U) << "not a nanosecond early";
  system.soc.advance(30 * kMs);
  EXPECT_EQ(system.result(2), Camera::kReady);
  EXPECT_EQ(system.result(3), 64U);
  EXPECT_EQ(system.result(4), 40U);
  EXPECT_EQ(system.result(5), 1U);
  EXPECT_NEAR(system.result(6), 2e6 + kDelayNs, 1000)
      << "ns: some tens of cycles of 10 ns into the handler, and its code is fetched";
  EXPECT_EQ(system.result(7), 1U);
  std::vector<std::uint8_t> found(bytes.size());
  ASSERT_TRUE(system.soc.memory().read(0x1C040000, found));
  EXPECT_EQ(found, bytes);
}

/// Returns a board whose camera has the line timing of an HM01B0.
BoardDescription with_lines(double frame_lines, double exposure_lines) {
  auto board = BoardSystem::narrow();
  for (auto& device : board.devices) {
    for (auto& variable : device.variables) {
      if (variable.name == "camera.frame_lines") variable.start = frame_lines;
      if (variable.name == "camera.exposure_lines") variable.start = exposure_lines;
    }
  }
  return board;
}

TEST(Camera, TakesTheTimeOfExposureAndRowsIfItHasLines) {
  BoardSystem system(fmt::format(fmt::runtime(kAsk), 4096, 0), {}, with_lines(260, 30));
  system.soc.advance(2 * kMs);
  system.camera().offer(picture(64 * 40), system.soc.now());
  // Exposure and rows are 30 and 40 lines of 376 clocks at 6 MHz.
  const auto ready_ns = 2 * kMs + 70 * 376 * 1000 / 6;
  system.soc.advance(ready_ns - 10);
  EXPECT_EQ(system.result(2), 0U);
  system.soc.advance(30 * kMs);
  EXPECT_NEAR(system.result(6), static_cast<double>(ready_ns), 1000);
}

TEST(Camera, ReadsOutAtMostOnePicturePerFrameIfItHasLines) {
  BoardSystem system(fmt::format(fmt::runtime(kAsk), 4096, 0), {}, with_lines(344, 30));
  system.soc.advance(2 * kMs);
  auto& camera = system.camera();
  const auto line_ps = [](std::int64_t lines) { return static_cast<double>(lines) * 376e12 / 6e6; };
  camera.offer(picture(64 * 40), system.soc.now());
  const auto first_done = camera.next_event();
  camera.advance(first_done);
  const auto now = first_done + kPsPerNs;
  ASSERT_TRUE(camera.store(0, now, 1));
  camera.offer(picture(64 * 40), now);
  EXPECT_NEAR(static_cast<double>(camera.next_event() - first_done), line_ps(344), 2);
}

TEST(Camera, RefusesFewerLinesThanRows) {
  BoardSystem system(fmt::format(fmt::runtime(kAsk), 4096, 0), {}, with_lines(39, 0));
  system.soc.advance(2 * kMs);
  EXPECT_THAT([&] { system.camera().offer(picture(64 * 40), system.soc.now()); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("camera.frame_lines 39 is too few")));
  BoardSystem exposed(fmt::format(fmt::runtime(kAsk), 4096, 0), {}, with_lines(60, 59));
  exposed.soc.advance(2 * kMs);
  EXPECT_THROW(exposed.camera().offer(picture(64 * 40), exposed.soc.now()), Error);
}

TEST(Camera, DropsPicturesOfAnotherSizeAndReportsItOnce) {
  // A picture of 160 x 160 would fill 80 rows of 320 without a remainder.
  BoardSystem system(fmt::format(fmt::runtime(kAsk), 320 * 320, 0));
  system.soc.advance(2 * kMs);
  system.camera().offer(picture(160 * 160), system.soc.now());
  system.soc.advance(30 * kMs);
  EXPECT_EQ(system.result(2), Camera::kRefused);
  EXPECT_EQ(system.result(7), 1U) << "the program learns of it";
  EXPECT_EQ(system.result(3), 0U);
  ASSERT_EQ(system.faults.size(), 1U);
  EXPECT_THAT(system.faults[0], testing::StartsWith("picture 1 has 25600 bytes, but camera.frame_width 320 and "
                                                    "camera.frame_height 320 make 102400"));

  ASSERT_TRUE(system.camera().store(0, system.soc.now(), 1));
  system.camera().offer(picture(8 * 320), system.soc.now());
  system.soc.advance(60 * kMs);
  EXPECT_EQ(system.result(7), 2U);
  EXPECT_EQ(system.faults.size(), 1U);

  ASSERT_TRUE(system.camera().store(0, system.soc.now(), 1));
  system.camera().offer(picture(320 * 320), system.soc.now());
  system.soc.advance(90 * kMs);
  EXPECT_EQ(system.result(2), Camera::kReady);
  EXPECT_EQ(system.result(4), 320U);
}

double seconds_of(const Soc& soc, ChipState state) {
  return static_cast<double>(soc.state_times().total(static_cast<std::size_t>(state))) * 1e-12;
}

TEST(StateTimes, AreWaitingUntilAPictureArrivesAndAsleepAfterwards) {
  BoardSystem system(fmt::format(fmt::runtime(kAsk), 4096, 0), {}, BoardSystem::narrow());
  system.soc.advance(2 * kMs);
  system.camera().offer(picture(64 * 40), system.soc.now());
  system.soc.advance(30 * kMs);
  const auto waiting_s = 2e-3 + kDelayNs * 1e-9;
  EXPECT_NEAR(seconds_of(system.soc, ChipState::waiting), waiting_s, 2e-6) << "less the first instructions";
  EXPECT_NEAR(seconds_of(system.soc, ChipState::asleep), 30e-3 - waiting_s, 2e-6);
  EXPECT_EQ(seconds_of(system.soc, ChipState::cluster), 0);
  double sum = 0;
  for (std::size_t i = 0; i < StateTimes::kCounted; ++i) sum += static_cast<double>(system.soc.state_times().total(i));
  EXPECT_EQ(sum, static_cast<double>(system.soc.now())) << "asleep at the end, so that no instruction reaches further";
  const auto slept_s = static_cast<double>(system.soc.sleep_time()) * 1e-12;
  EXPECT_NEAR(seconds_of(system.soc, ChipState::waiting) + seconds_of(system.soc, ChipState::asleep), slept_s, 1e-12);
}

TEST(StateTimes, DoNotDependOnTheStepsForTheCluster) {
  constexpr std::string_view kTwoMilliseconds = R"(
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
)";
  BoardSystem whole(kTwoMilliseconds);
  whole.soc.advance(5 * kMs);
  EXPECT_NEAR(seconds_of(whole.soc, ChipState::cluster), 2e-3, 1e-6);
  EXPECT_NEAR(seconds_of(whole.soc, ChipState::asleep), 3e-3, 2e-6);
  BoardSystem stepped(kTwoMilliseconds);
  for (int i = 1; i <= 500; ++i) stepped.soc.advance(i * 10'000);
  for (std::size_t i = 0; i < StateTimes::kCounted; ++i) {
    EXPECT_EQ(stepped.soc.state_times().total(i), whole.soc.state_times().total(i)) << i;
  }
  stepped.soc.power_off();
  stepped.soc.advance(9 * kMs);
  EXPECT_EQ(seconds_of(stepped.soc, ChipState::asleep), seconds_of(whole.soc, ChipState::asleep))
      << "off is not asleep";
}

TEST(Camera, RefusesASecondRequestWhileBusyAndKeepsTheFirst) {
  BoardSystem system(fmt::format(fmt::runtime(kAsk), 4096, 1), {}, BoardSystem::narrow());
  system.soc.advance(2 * kMs);
  EXPECT_EQ(system.result(1), Camera::kBusy | Camera::kRefused);
  EXPECT_EQ(system.camera().requests(), 1);
  EXPECT_EQ(system.result(7), 0U) << "a refusal on the spot raises no interrupt";
}

TEST(Camera, RefusesABufferOutsideTheRam) {
  BoardSystem system(fmt::format(fmt::runtime(kAsk), 0x100000, 0), {}, BoardSystem::narrow());
  system.soc.advance(2 * kMs);
  EXPECT_EQ(system.result(0), Camera::kRefused);
  EXPECT_EQ(system.camera().requests(), 0);
}

TEST(Camera, DropsAPictureThatDoesNotFitAndReportsIt) {
  BoardSystem system(fmt::format(fmt::runtime(kAsk), 100, 0), {}, BoardSystem::narrow());
  system.soc.advance(2 * kMs);
  const auto bytes = picture(64 * 40);
  system.camera().offer(bytes, system.soc.now());
  system.soc.advance(30 * kMs);
  EXPECT_EQ(system.result(2), Camera::kRefused);
  EXPECT_EQ(system.result(7), 1U) << "interrupt, so that the firmware does not wait without end";
  ASSERT_EQ(system.faults.size(), 1U);
  EXPECT_THAT(system.faults[0], testing::HasSubstr("2560 bytes"));
}

TEST(Camera, DrawsItsActiveCurrentForTheDelayAndItsIdleCurrentOtherwise) {
  BoardSystem system(fmt::format(fmt::runtime(kAsk), 4096, 0), {}, BoardSystem::narrow());
  system.soc.advance(2 * kMs);
  system.camera().offer(picture(64 * 40), system.soc.now());
  system.soc.advance(100 * kMs);
  const double active_s = 0.0166667;
  const double expected_j = 2.8 * (1.75e-3 * active_s + 0.14e-3 * (0.1 - active_s));
  EXPECT_NEAR(system.camera_energy_j(), expected_j, 1e-15) << "rounding of sums of about 1e-4 J";
}

TEST(Camera, OverwritesCodeThatThenRunsAsWritten) {
  // The picture overwrites "target", which ran before as "addi a0, a0, 1; ret".
  BoardSystem system(R"(
_start: la s2, target
    jalr s2
    li s0, CAMERA_BASE
    sw s2, CAMERA_BUFFER_OFFSET(s0)
    li a1, 8
    sw a1, CAMERA_BUFFER_SIZE_OFFSET(s0)
    li a1, 1
    sw a1, CAMERA_CONTROL_OFFSET(s0)
1:  lw a1, CAMERA_STATUS_OFFSET(s0)
    andi a1, a1, 2
    beqz a1, 1b
    jalr s2
2:  j 2b
    .balign 4
target: .option norvc
    addi a0, a0, 1
    ret
)",
                     {}, BoardSystem::narrow(8));
  system.soc.advance(1 * kMs);
  EXPECT_EQ(system.soc.hart().reg(10), 1U);
  const std::vector<std::uint8_t> code{0x13, 0x05, 0x05, 0x10, 0x67, 0x80, 0x00, 0x00};  // addi a0, a0, 256; ret
  system.camera().offer(code, system.soc.now());
  system.soc.advance(20 * kMs);
  EXPECT_EQ(system.soc.hart().reg(10), 257U);
}

}  // namespace
}  // namespace mebots::soc::test
