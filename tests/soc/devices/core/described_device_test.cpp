// SPDX-License-Identifier: Apache-2.0
// Tests a device that exists only in the board file: the time-of-flight sensor of examples/time_of_flight.
#include "devices/core/described_device.hpp"

#include "mebots/error.hpp"
#include "mebots/state/save.hpp"
#include "mebots/text_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc {
namespace {

using testing::HasSubstr;

constexpr std::uint32_t kCommand = 0;
constexpr std::uint32_t kStatus = 4;
constexpr std::uint32_t kDistance = 8;
constexpr std::uint32_t kReport = 12;
constexpr Picoseconds kMillisecond = 1'000'000'000;

std::string board_text() {
  return text_of(MEBOTS_SOURCE_DIR "/examples/time_of_flight/board.json");
}

/// Only records the complaints of devices.
class Ear final : public DeviceHost {
 public:
  bool read_memory(std::uint32_t /*address*/, std::span<std::uint8_t> /*bytes*/) const override { return false; }
  bool write_memory(std::uint32_t /*address*/, std::span<const std::uint8_t> /*bytes*/) override { return false; }
  bool is_memory(std::uint32_t /*address*/, std::uint32_t /*size*/) const override { return false; }
  void print(std::string_view /*line*/) override {}
  void complain(std::string_view text) override { complaints.emplace_back(text); }

  std::vector<std::string> complaints;
};

Ear& ear() {
  static Ear instance;
  return instance;
}

DescribedDevice range_finder() {
  static const auto entry = parse_board(board_text(), "board.json").devices.back();
  return {entry, ear()};
}

std::uint32_t read(DescribedDevice& device, std::uint32_t offset) {
  std::uint32_t value = 0;
  EXPECT_TRUE(device.load(offset, 0, value));
  return value;
}

TEST(DescribedDevice, ShowsTheVariablesValueAtTheEndOfTheDelay) {
  auto device = range_finder();
  EXPECT_EQ(device.next_event(), kNever);
  EXPECT_TRUE(device.store(kCommand, 10 * kMillisecond, 1));
  EXPECT_EQ(device.state_name(), "ranging");
  EXPECT_EQ(read(device, kStatus), DescribedDevice::kBusy);
  EXPECT_EQ(device.next_event(), 43 * kMillisecond);
  *device.input("range_finder.distance") = 0.4567;
  EXPECT_EQ(read(device, kDistance), 0U) << "not measured yet";
  device.advance(43 * kMillisecond);
  EXPECT_TRUE(device.interrupt());
  EXPECT_EQ(device.state_name(), "standby");
  *device.input("range_finder.distance") = 3;
  EXPECT_EQ(read(device, kDistance), 457U);
  EXPECT_EQ(read(device, kStatus), DescribedDevice::kReady);
  device.store(kStatus, 44 * kMillisecond, DescribedDevice::kReady);
  EXPECT_FALSE(device.interrupt());
  EXPECT_EQ(device.input("range_finder.colour"), nullptr);
}

TEST(DescribedDevice, RefusesUnknownOpcodesAndASecondMeasurementButNotAStop) {
  auto device = range_finder();
  device.store(kCommand, 0, 7);
  EXPECT_EQ(read(device, kStatus), DescribedDevice::kRefused);
  device.store(kStatus, 0, DescribedDevice::kRefused);
  device.store(kCommand, 0, 1);
  device.store(kCommand, kMillisecond, 1);
  EXPECT_EQ(read(device, kStatus), DescribedDevice::kBusy | DescribedDevice::kRefused);
  EXPECT_EQ(device.next_event(), 33 * kMillisecond) << "the first one continues";
  device.store(kCommand, 2 * kMillisecond, 2);
  EXPECT_EQ(device.next_event(), kNever);
  EXPECT_FALSE(device.interrupt());
}

TEST(DescribedDevice, RefusesOtherKindsOfAccess) {
  auto device = range_finder();
  std::uint32_t value = 0;
  EXPECT_FALSE(device.load(kCommand, 0, value)) << "write only";
  EXPECT_FALSE(device.store(kDistance, 0, 1)) << "read only";
  EXPECT_FALSE(device.load(0x10, 0, value));
}

TEST(DescribedDevice, DrawsTheCurrentOfItsStates) {
  auto device = range_finder();
  device.store(kCommand, 10 * kMillisecond, 1);
  device.advance(43 * kMillisecond);
  const auto expected_j = 2.8 * (16e-3 * 33e-3 + 6e-6 * 67e-3);
  EXPECT_NEAR(device.energy_j(100 * kMillisecond), expected_j, 1e-12 * expected_j) << "sums of doubles";
}

TEST(DescribedDevice, ContinuesFromAState) {
  auto device = range_finder();
  *device.input("range_finder.distance") = 2;
  device.store(kCommand, 5 * kMillisecond, 1);
  auto other = range_finder();
  state::restore(other, state::save(device));
  other.advance(38 * kMillisecond);
  EXPECT_EQ(read(other, kDistance), 2000U);
}

struct Mistake {
  std::string from;
  std::string to;
  std::string complaint;
};

TEST(DescribedDevice, IsRefusedIfItsDescriptionIsInconsistent) {
  for (const auto& mistake :
       {Mistake{"\"then\": \"standby\"", "\"then\": \"asleep\"", "the device's state 'asleep' is unknown"},
        Mistake{"\"then\": \"standby\", ", "", "'then' is missing: the state has a delay"},
        Mistake{"\"delay\": 0.033", "\"delay\": 1e-9", "at least 1e-06 s"},
        Mistake{"\"register\": \"COMMAND\"", "\"register\": \"DISTANCE\"",
                "the writable register 'DISTANCE' is unknown"},
        Mistake{"\"shows\": \"range_finder.distance\"", "\"shows\": \"colour\"",
                "the device's input 'colour' is unknown"},
        Mistake{"\"sends\": \"range_finder.reported\"", "\"sends\": \"colour\"",
                "the device's output 'colour' is unknown"},
        Mistake{"\"access\": \"rw\", \"sends\"", "\"access\": \"r\", \"sends\"",
                "must be writable, and must not show a variable"},
        Mistake{"\"causality\": \"input\"", "\"causality\": \"local\"", "the word 'local'"},
        Mistake{"\"causality\": \"input\"", "\"type\": \"String\", \"causality\": \"input\"",
                "numbers only, no String"},
        Mistake{"\"initial_state\": \"standby\",", "", "'initial_state' is missing"},
        Mistake{"\"initial_state\": \"standby\"", "\"initial_state\": \"on\"", "the device's state 'on' is unknown"}}) {
    auto text = board_text();
    const auto at = text.find(mistake.from);
    ASSERT_NE(at, std::string::npos) << mistake.from;
    text.replace(at, mistake.from.size(), mistake.to);
    try {
      parse_board(text, "board.json");
      ADD_FAILURE() << mistake.to;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(mistake.complaint));
      EXPECT_THAT(error.what(), HasSubstr("board.json"));
    }
  }
}

TEST(BoardFile, RefusesUnknownNamesAlsoInADeviceWithItsOwnModel) {
  for (const auto& mistake :
       {Mistake{"\"then\": \"standby\"", "\"then\": \"asleep\"", "the device's state 'asleep' is unknown"},
        Mistake{"\"shows\": \"range_finder.distance\"", "\"shows\": \"colour\"",
                "the device's input 'colour' is unknown"},
        Mistake{"\"sends\": \"range_finder.reported\"", "\"sends\": \"colour\"",
                "the device's output 'colour' is unknown"}}) {
    auto text = board_text();
    const std::string described = "\"initial_state\": \"standby\",";
    text.replace(text.find(described), described.size(), "\"kind\": \"ranger\",");
    EXPECT_NO_THROW(parse_board(text, "board.json"));
    text.replace(text.find(mistake.from), mistake.from.size(), mistake.to);
    EXPECT_THAT([&] { parse_board(text, "board.json"); }, testing::ThrowsMessage<Error>(HasSubstr(mistake.complaint)));
  }
}

TEST(DescribedDevice, SendsWhatIsStoredIntoARegister) {
  auto device = range_finder();
  const auto* reported = device.output("range_finder.reported");
  ASSERT_NE(reported, nullptr);
  EXPECT_EQ(*reported, 0.0);
  EXPECT_TRUE(device.store(kReport, 0, 1234));
  EXPECT_EQ(*reported, 1.234);
  EXPECT_EQ(read(device, kReport), 1234U);
  EXPECT_TRUE(device.store(kReport, 0, 0xffffffffU));
  EXPECT_EQ(*reported, -0.001) << "with a sign";
  EXPECT_EQ(device.output("range_finder.power"), nullptr) << "no register sends it";
}

/// Returns a device that has an input and a parameter in registers, and that sends all set-points at the same time.
BoardDevice link() {
  return parse_board(R"({
    "name": "b", "memories": [{"name": "ram", "base": "0x1000", "size": 4096}],
    "devices": [{
      "name": "link", "base": "0x8000",
      "registers": [
        {"name": "MODE", "offset": "0x0", "access": "rw", "sends": "link.mode"},
        {"name": "SPEED", "offset": "0x4", "access": "rw", "sends": "link.speed", "units_per_si": 1000, "min": -500, "max": 500},
        {"name": "COMMIT", "offset": "0x8", "access": "w", "commits": true},
        {"name": "BLOCKED", "offset": "0xC", "access": "r", "shows": "link.blocked"},
        {"name": "HEADING", "offset": "0x10", "access": "r", "shows": "link.heading", "units_per_si": 1e6},
        {"name": "GAIN", "offset": "0x14", "access": "r", "shows": "link.gain", "units_per_si": 1e6}
      ],
      "enumerations": {"Mode": {"stop": 0, "drive": 4}},
      "variables": [
        {"name": "link.mode", "type": "Mode", "causality": "output", "text": ""},
        {"name": "link.speed", "causality": "output", "unit": "m/s", "text": ""},
        {"name": "link.blocked", "type": "Boolean", "causality": "input", "start": true, "text": ""},
        {"name": "link.heading", "causality": "input", "unit": "rad", "start": 0, "text": ""},
        {"name": "link.gain", "causality": "parameter", "unit": "1", "start": 0.5, "text": ""}
      ]
    }]
  })",
                     "link.json")
      .devices.back();
}

TEST(DescribedDevice, ShowsInputsAndParametersDirectlyIfItHasNoStates) {
  const auto entry = link();
  DescribedDevice device(entry, ear());
  EXPECT_EQ(read(device, 0xC), 1U) << "true at the start";
  EXPECT_EQ(read(device, 0x14), 500'000U) << "the start of the board file, in the register's unit";
  *device.input("link.heading") = -0.25;
  *device.input("link.blocked") = 0;
  EXPECT_EQ(read(device, 0x10), static_cast<std::uint32_t>(-250'000));
  EXPECT_EQ(read(device, 0xC), 0U);
  EXPECT_EQ(device.state_name(), "");
  EXPECT_EQ(device.energy_j(kMillisecond), 0);
}

TEST(DescribedDevice, ReportsASetParameterThatTheProgramNeverRead) {
  const auto entry = link();
  for (const bool is_read : {false, true}) {
    DescribedDevice device(entry, ear());
    ear().complaints.clear();
    device.program_ended();
    EXPECT_TRUE(ear().complaints.empty()) << "it has its start value";
    *device.input("link.gain") = 0.75;
    if (is_read) read(device, 0x14);
    device.program_ended();
    if (is_read) {
      EXPECT_TRUE(ear().complaints.empty());
    } else {
      ASSERT_EQ(ear().complaints.size(), 1U);
      EXPECT_EQ(ear().complaints[0], "link.gain = 0.75 had no effect: the program ended without reading it");
    }
  }
}

TEST(DescribedDevice, CommitsAllOutputsOrNone) {
  const auto entry = link();
  DescribedDevice device(entry, ear());
  ear().complaints.clear();
  const auto* mode = device.output("link.mode");
  const auto* speed = device.output("link.speed");
  device.store(0, 0, 4);
  device.store(4, 0, static_cast<std::uint32_t>(-250));
  EXPECT_EQ(*mode, 0) << "nothing before the commit";
  device.store(8, 0, 0);
  EXPECT_EQ(*mode, 4);
  EXPECT_EQ(*speed, -0.25);
  device.store(4, 0, 501);
  device.store(8, 0, 0);
  device.store(4, 0, 100);
  device.store(0, 0, 3);
  device.store(8, 0, 0);
  EXPECT_EQ(*speed, -0.25) << "not even what is right";
  ASSERT_EQ(ear().complaints.size(), 2U);
  EXPECT_THAT(ear().complaints[0], HasSubstr("link: SPEED 501 is above 500"));
  EXPECT_THAT(ear().complaints[1], HasSubstr("MODE 3 is not a value of Mode (stop 0, drive 4)"));

  DescribedDevice other(entry, ear());
  state::restore(other, state::save(device));
  EXPECT_EQ(*other.output("link.mode"), 4);
  EXPECT_EQ(read(other, 4), 100U) << "the draft";
}

TEST(BoardFile, RefusesAnOutputWithoutASender) {
  auto text = board_text();
  const std::string sends = "\"sends\": \"range_finder.reported\", ";
  text.erase(text.find(sends), sends.size());
  EXPECT_THAT([&] { parse_board(text, "board.json"); },
              testing::ThrowsMessage<Error>(HasSubstr("range_finder.reported must be sent by one register")));
}

}  // namespace
}  // namespace mebots::soc
