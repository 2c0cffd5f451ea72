// SPDX-License-Identifier: Apache-2.0
//
// Tests the UART between two chips. A byte takes 10 bits at 115200 baud, which is 86805556 ps. The expected checksum is
// from the catalogue of CRCs (reveng).
#include "soc/soc.hpp"

#include "assembler.hpp"
#include "devices/generic/uart_text.hpp"
#include "drivers/setpoint_frame.h"
#include "mebots/error.hpp"
#include "mebots/state/save.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mebots::soc::test {
namespace {

constexpr Picoseconds kUs = 1'000'000;
constexpr Picoseconds kMs = 1'000 * kUs;
constexpr Picoseconds kByte = 86'805'556;
constexpr std::uint32_t kData = 0x0, kStatus = 0x4, kBaud = 0x8, kStopBits = 0xc, kThreshold = 0x10;

/// A sleeping chip on the board with the UART.
class Chip {
 public:
  Chip()
      : soc_(read_board(MEBOTS_UART_BOARD), gap8(), {}, assemble("_start: wfi\nj _start\n", 0x1C000000),
             {{}, [this](std::string_view text) { complaints.emplace_back(text); }, {}}) {}

  Device& uart() { return *soc_.devices().find("uart"); }
  void store(std::uint32_t offset, std::uint32_t value, Picoseconds now = 0) {
    EXPECT_TRUE(uart().store(offset, now, value)) << offset;
  }
  std::uint32_t load(std::uint32_t offset) {
    std::uint32_t value = 0;
    EXPECT_TRUE(uart().load(offset, 0, value)) << offset;
    return value;
  }
  double number(std::string_view variable) { return *uart().output(variable); }
  double& input(std::string_view variable) { return *uart().input(variable); }
  const std::string& sent() { return *uart().text_output("uart.sent"); }
  /// Performs a step up to `end`, in which `received` arrives on the line.
  void step(Picoseconds end, std::string_view received = "") {
    *uart().text_input("uart.received") = received;
    uart().begin_step(begin_);
    while (uart().next_event() <= end) uart().advance(uart().next_event());
    begin_ = end;
  }

  std::vector<std::string> complaints;

 private:
  Picoseconds begin_ = 0;
  Soc soc_;
};

TEST(Uart, ByteTakesTenBitsAtTheBaudRate) {
  Chip chip;
  chip.step(0);
  chip.store(kData, 0x11, 5 * kUs);
  chip.store(kData, 0x22, 6 * kUs);
  chip.step(kMs);
  EXPECT_EQ(chip.sent(), fmt::format("0 =8680556 11@{} 22@{}", 5 * kUs + kByte, 5 * kUs + 2 * kByte));
  chip.store(kBaud, 1'000'000, kMs);
  chip.store(kStopBits, 2, kMs);
  chip.store(kData, 0x33, kMs);
  chip.step(2 * kMs);
  EXPECT_EQ(chip.sent(), "2 =1000000 33@11000000") << "two stop bits, 1 Mbit/s; time since the start of the step";
  chip.step(3 * kMs);
  EXPECT_EQ(chip.sent(), "");
  EXPECT_EQ(chip.number("uart.bytes_sent"), 3);
}

TEST(Uart, ByteArrivesOneStepAfterItsEnd) {
  Chip sender;
  Chip receiver;
  sender.step(0);
  sender.store(kData, 0xa5, 7 * kUs);
  sender.step(kMs);
  receiver.step(kMs);
  receiver.step(kMs + 7 * kUs + kByte - 1, sender.sent());
  EXPECT_EQ(receiver.load(kStatus) & 0xff, 0U);
  receiver.step(2 * kMs);
  EXPECT_EQ(receiver.load(kStatus) & 0xff, 1U);
  EXPECT_EQ(receiver.load(kData), 0xa5U);
  EXPECT_EQ(receiver.load(kData), 0U) << "empty";
}

TEST(Uart, ReceiverWithShorterStepsTakesEachByteOnce) {
  Chip receiver;
  const std::string text = "0 =8680556 01@100000000 02@1900000000";
  for (int i = 1; i <= 4; ++i) receiver.step(i * kMs / 2, text);
  EXPECT_EQ(receiver.number("uart.bytes_received"), 2);
  EXPECT_EQ(receiver.load(kData), 1U);
  EXPECT_EQ(receiver.load(kData), 2U);
}

TEST(Uart, MissedBytesOfALongerStepAreCountedAndReported) {
  Chip receiver;
  receiver.step(kMs, "0 =8680556 01@100000000");
  receiver.step(2 * kMs, "4 =8680556 05@100000000");
  EXPECT_EQ(receiver.number("uart.bytes_lost"), 3);
  ASSERT_EQ(receiver.complaints.size(), 1U);
  EXPECT_THAT(receiver.complaints[0], testing::HasSubstr("uart: 3 bytes of the sender never arrived"));
}

TEST(Uart, FullFifosLoseBytesAndReportTheFirst) {
  Chip chip;
  chip.input("uart.fifo_depth") = 2;
  chip.step(kMs, "0 =8680556 01@1 02@2 03@3 04@4");
  EXPECT_EQ(chip.load(kStatus), 2U | 2U << 8 | 1U << 17);
  EXPECT_EQ(chip.number("uart.bytes_lost"), 2);
  for (std::uint32_t i = 0; i < 4; ++i) chip.store(kData, i, kMs);  // one byte is on the line, two are in the FIFO
  EXPECT_EQ(chip.load(kStatus), 2U | 1U << 16 | 1U << 17 | 1U << 18);
  EXPECT_EQ(chip.number("uart.bytes_lost"), 3);
  chip.store(kStatus, 3U << 17);
  EXPECT_EQ(chip.load(kStatus), 2U | 1U << 16);
  ASSERT_EQ(chip.complaints.size(), 1U);
  EXPECT_THAT(chip.complaints[0], testing::HasSubstr("the receive FIFO of 2 bytes was full"));
}

TEST(Uart, ASettingOutOfRangeEndsTheStepWithAWayOut) {
  Chip chip;
  chip.input("uart.fifo_depth") = 0;
  EXPECT_THAT([&] { chip.step(kMs); },
              testing::ThrowsMessage<Error>(testing::StartsWith(
                  "uart.fifo_depth = 0 must be from 1 to 255; change this parameter of the chip, or")));
}

/// The last sample is 9.5 bits after the start bit's edge. Its error must be less than half a bit, so the rate may
/// differ by 1 / 19.
TEST(Uart, ByteOfAnotherBaudRateIsGarbled) {
  for (const auto& [bit, garbled] : {std::pair{8'680'556, false},
                                     {9'100'000, false},
                                     {8'250'000, false},
                                     {9'150'000, true},
                                     {8'200'000, true},
                                     {17'361'111, true}}) {
    Chip chip;
    chip.step(kMs, fmt::format("0 ={} 41@100000000", bit));
    EXPECT_EQ(chip.number("uart.bytes_garbled"), garbled ? 1 : 0) << bit;
    EXPECT_EQ(chip.load(kStatus) >> 19 & 1, garbled ? 1U : 0U) << bit;
    EXPECT_EQ(chip.load(kStatus) & 0xff, garbled ? 0U : 1U) << bit;
  }
}

TEST(Uart, WrongBitsDependOnTheSeedAndTheByteOnly) {
  const auto received = [](double rate, double seed) {
    Chip chip;
    chip.input("uart.error_rate") = rate;
    chip.input("uart.seed") = seed;
    std::vector<std::uint32_t> bytes;
    for (int i = 0; i < 200; ++i) {
      chip.step((i + 1) * kMs, fmt::format("{} =8680556 00@1000", i));
      bytes.push_back(chip.load(kData));
    }
    return bytes;
  };
  for (const auto byte : received(1, 1)) EXPECT_EQ(std::popcount(byte), 1);
  EXPECT_EQ(received(1, 1), received(1, 1));
  EXPECT_NE(received(1, 1), received(1, 2));
  // 200 draws with probability 0.25 have the mean 50 and the standard deviation 6.1. The tolerance is four standard
  // deviations.
  EXPECT_NEAR(200 - std::ranges::count(received(0.25, 7), 0U), 50, 25);
}

TEST(Uart, InterruptIsUpWhileTheFifoHasAsManyBytesAsTheThreshold) {
  Chip chip;
  chip.store(kThreshold, 2);
  chip.step(kMs, "0 =8680556 01@1");
  EXPECT_FALSE(chip.uart().interrupt());
  chip.step(2 * kMs, "1 =8680556 02@1");
  EXPECT_TRUE(chip.uart().interrupt());
  chip.load(kData);
  EXPECT_FALSE(chip.uart().interrupt());
}

TEST(Uart, RefusesBaudRatesAndStopBitsThatItLacks) {
  Chip chip;
  chip.store(kBaud, 299);
  EXPECT_EQ(chip.load(kBaud), 115'200U);
  EXPECT_EQ(chip.load(kStatus) >> 20, 1U);
  chip.store(kStatus, 1U << 20);
  chip.store(kStopBits, 3);
  EXPECT_EQ(chip.load(kStopBits), 1U);
  EXPECT_EQ(chip.load(kStatus) >> 20, 1U);
}

TEST(Uart, ConsumesTheCurrentOfItsStatesWhileItTransmits) {
  Chip chip;
  chip.step(0);
  for (int i = 0; i < 10; ++i) chip.store(kData, 0x55, 0);
  chip.step(5 * kMs);
  EXPECT_NEAR(chip.uart().energy_j(5 * kMs), 3.0 * 5.2e-6 * 10 * 1e-12 * kByte, 1e-18);
}

TEST(Uart, RefusesTextsThatAreNoBytes) {
  for (const auto* text : {"x", "0", "0 =8680556", "0 01@5", "0 =8680556 01@5 02@4", "0 =8680556 100@5",
                           "0 =8680556 01", "0 =8680556 01@-5", "0 =0 01@5", "0  =8680556 01@5", "0 =8680556 01@5 ",
                           "-1 =8680556 01@5", "99999999999999999999 =8680556 01@5"}) {
    Chip chip;
    try {
      chip.step(kMs, text);
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_value) << text;
      EXPECT_THAT(error.what(), testing::StartsWith(fmt::format("uart.received = \"{}\"", text)));
    }
  }
}

TEST(Uart, RestoredStateSendsAndReceivesTheSameBytes) {
  Chip straight;
  straight.step(0);
  for (std::uint32_t i = 0; i < 20; ++i) straight.store(kData, i, 3 * kUs);
  straight.step(kMs, "0 =8680556 01@100000000 02@900000000");
  const auto saved = state::save(straight.uart());
  straight.step(2 * kMs, "2 =8680556 03@1");

  Chip restored;
  restored.store(kData, 0xff, 0);
  restored.step(kMs);
  state::restore(restored.uart(), saved);
  restored.step(2 * kMs, "2 =8680556 03@1");
  EXPECT_EQ(straight.sent(), restored.sent());
  EXPECT_NE(straight.sent(), "");
  EXPECT_EQ(state::save(straight.uart()), state::save(restored.uart()));
}

TEST(Uart, RestoredStateInTheMiddleOfAStepTakesEachByteOnce) {
  const std::string text = "0 =8680556 01@100000000 02@900000000";
  Chip straight;
  straight.step(kMs / 2, text);
  const auto saved = state::save(straight.uart());
  Chip restored;
  state::restore(restored.uart(), saved);
  EXPECT_EQ(restored.load(kData), 1U);
  EXPECT_EQ(restored.uart().next_event(), 900 * kUs);
  restored.uart().advance(900 * kUs);
  EXPECT_EQ(restored.load(kData), 2U);
  EXPECT_EQ(restored.uart().next_event(), kNever);
  EXPECT_EQ(restored.number("uart.bytes_received"), 2);
}

TEST(Uart, RefusesADamagedState) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const auto& [variable, value] : {std::pair{"uart.baud", kInfinite},
                                        {"uart.baud", std::nan("")},
                                        {"uart.baud", 1e14},
                                        {"uart.fifo_depth", 256.0},
                                        {"uart.error_rate", -0.1},
                                        {"uart.seed", 1e300}}) {
    Chip damaged;
    damaged.input(variable) = value;
    const auto saved = state::save(damaged.uart());
    Chip chip;
    try {
      state::restore(chip.uart(), saved);
      ADD_FAILURE() << variable << " = " << value;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::state_damaged) << variable << " = " << value;
    }
  }
}

std::vector<setpoint_t> frames_in(setpoint_reader_t& reader, const std::vector<std::uint8_t>& bytes) {
  std::vector<setpoint_t> found;
  for (const auto byte : bytes) {
    setpoint_t setpoint;
    if (setpoint_reader_take(&reader, byte, &setpoint)) found.push_back(setpoint);
  }
  return found;
}

std::vector<std::uint8_t> frame_of(const setpoint_t& setpoint, std::uint8_t number) {
  std::vector<std::uint8_t> frame(SETPOINT_FRAME_BYTES);
  setpoint_frame_write(&setpoint, number, frame.data());
  return frame;
}

TEST(SetpointFrame, ChecksumIsThatOfTheCatalogue) {
  EXPECT_EQ(setpoint_frame_checksum(reinterpret_cast<const std::uint8_t*>("123456789"), 9), 0x29b1);
}

TEST(SetpointFrame, ReaderFindsFramesBetweenOtherBytes) {
  const setpoint_t wanted{2, -277'778, 500'000, 1'000'000};
  std::vector<std::uint8_t> bytes{0x00, 0xa5, 0xa5, 0x13};
  for (const int number : {254, 255, 0}) {
    const auto frame = frame_of(wanted, static_cast<std::uint8_t>(number));
    bytes.insert(bytes.end(), frame.begin(), frame.end());
  }
  setpoint_reader_t reader{};
  const auto found = frames_in(reader, bytes);
  ASSERT_EQ(found.size(), 3U) << "a mark before a frame costs no frame";
  EXPECT_EQ(found[0].mode, 2U);
  EXPECT_EQ(found[0].velocity_x_um_s, -277'778);
  EXPECT_EQ(found[0].yaw_rate_urad_s, 500'000);
  EXPECT_EQ(found[0].altitude_um, 1'000'000);
  EXPECT_EQ(reader.lost, 0U);
}

TEST(SetpointFrame, ReaderDropsEveryFrameWithAWrongBitAndCountsIt) {
  const setpoint_t wanted{1, 0xa5a5, 0, 0xa5};
  for (std::size_t bit = 0; bit < 8 * SETPOINT_FRAME_BYTES; ++bit) {
    setpoint_reader_t reader{};
    auto bytes = frame_of(wanted, 0);
    auto damaged = frame_of(wanted, 1);
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    const auto last = frame_of(wanted, 2);
    bytes.insert(bytes.end(), damaged.begin(), damaged.end());
    bytes.insert(bytes.end(), last.begin(), last.end());
    EXPECT_EQ(frames_in(reader, bytes).size(), 2U) << bit;
    EXPECT_EQ(reader.lost, 1U) << bit;
  }
}

}  // namespace
}  // namespace mebots::soc::test
