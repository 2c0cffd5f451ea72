// SPDX-License-Identifier: Apache-2.0
// Tests the registers of GAP8's real-time clock and advanced timer against the public headers.
#include "devices/gap8/advanced_timer.hpp"
#include "devices/gap8/rtc.hpp"
#include "support/same_state.hpp"

#include "mebots/state/save.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace mebots::soc::test {
namespace {

using testing::ElementsAre;
using testing::Pair;

class Gap8Rtc : public testing::Test {
 protected:
  Gap8Rtc() {
    signals.raise_soc_event = [this](unsigned event, Picoseconds now) { heard.emplace_back(event, now); };
    set(0x10, 0, 0);
  }
  void window(std::uint32_t control, Picoseconds now) {
    ASSERT_TRUE(rtc.store(0x04, now, control));
    ASSERT_TRUE(rtc.store(0x18, now, 3));
    ASSERT_EQ(heard.back().first, 43U) << "each access through the window raises an event";
    heard.pop_back();
  }
  void set(std::uint32_t number, std::uint32_t value, Picoseconds now) {
    rtc.store(0x08, now, value);
    window(1U << 16 | number, now);
  }
  std::uint32_t get(std::uint32_t number, Picoseconds now) {
    window(number, now);
    std::uint32_t value = 0;
    rtc.load(0x08, now, value);
    return value;
  }

  static constexpr Picoseconds kSecond = 1'000'000'000'000;
  gap8_devices::Signals signals;
  gap8_devices::Rtc rtc{signals};
  std::vector<std::pair<unsigned, Picoseconds>> heard;
};

TEST_F(Gap8Rtc, CalendarPassesTheEndOfFebruaryInALeapYearAndOfAYear) {
  set(0x13, 0x240228, 0);  // sets the date to 28 February 2024
  set(0x12, 0x235958, 0);
  EXPECT_EQ(get(0x12, kSecond), 0x235959U);
  EXPECT_EQ(get(0x12, 2 * kSecond), 0U);
  EXPECT_EQ(get(0x13, 2 * kSecond), 0x240229U);
  set(0x13, 0x231231, 2 * kSecond);
  set(0x12, 0x235959, 2 * kSecond);
  EXPECT_EQ(get(0x13, 3 * kSecond), 0x240101U);
  EXPECT_EQ(rtc.next_event(), kNever) << "no one waits for it";
}

TEST_F(Gap8Rtc, AlarmRaisesItsEventOnceOrWheneverItsFieldsMatch) {
  set(0x1A, 0x000003, 0);
  set(0x1B, get(0x13, 0), 0);
  set(0x18, 0, 0);
  for (auto time = rtc.next_event(); time < 10 * kSecond; time = rtc.next_event()) rtc.advance(time);
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_EQ(heard[0], (std::pair{44U, 3 * kSecond}));
  EXPECT_EQ(get(0x0A, 10 * kSecond), 1U);
  heard.clear();
  set(0x0A, 1, 10 * kSecond);
  EXPECT_EQ(get(0x0A, 10 * kSecond), 0U);
  set(0x18, 4U << 16 | 1U << 4, 10 * kSecond);  // sets the alarm to second 3 of each minute
  for (auto time = rtc.next_event(); time < 190 * kSecond; time = rtc.next_event()) {
    rtc.advance(time);
    set(0x0A, 1, time);
  }
  ASSERT_EQ(heard.size(), 3U);
  EXPECT_EQ(heard[2].second, 183 * kSecond);
}

TEST_F(Gap8Rtc, CountdownTakesOneTickMoreThanItsValueAndCanBeMasked) {
  set(0x28, 32, 0);  // after the restart, a tick takes 1/1024 s
  set(0x01, 1, 0);
  set(0x01, 0, 0);
  set(0x21, 9, 0);
  set(0x20, 0, 0);
  const auto end = gap8_devices::reference_edge_time(320);
  EXPECT_EQ(rtc.next_event(), end);
  rtc.advance(end);
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_EQ(get(0x20, end) & 1U, 1U) << "off";
  set(0x0A, 0x10, end);
  set(0x09, 0x10, end);
  set(0x21, 0, end);
  set(0x20, 0x10, end);
  heard.clear();
  rtc.advance(rtc.next_event());
  EXPECT_TRUE(heard.empty());
  EXPECT_EQ(get(0x0A, kSecond) & 0x10U, 0x10U);
}

TEST_F(Gap8Rtc, CountdownBeyondAllTimesRaisesNoEvent) {
  set(0x21, 0xffffffffU, 0);
  set(0x20, 0, 0);
  EXPECT_EQ(rtc.next_event(), kNever) << "136 years";
  set(0x21, 0x800000U, 0);
  EXPECT_EQ(rtc.next_event(), (0x800000 + 1) * kSecond);
}

class Gap8AdvancedTimer : public testing::Test {
 protected:
  static constexpr std::uint32_t kSaw = 1U << 12;
  static constexpr std::uint32_t kSetThenClear = 2U << 16;
  static constexpr std::uint32_t kClearThenSet = 6U << 16;
  static constexpr std::uint32_t kToggle = 3U << 16;
  static constexpr Picoseconds kTick = 10'000;  // of 100 MHz

  Gap8AdvancedTimer() {
    signals.raise_soc_event = [this](unsigned event, Picoseconds now) { heard.emplace_back(event, now / kTick); };
  }
  void set(std::uint32_t offset, std::uint32_t value, Picoseconds now = 0) {
    ASSERT_TRUE(timer.store(offset, now, value));
  }
  std::uint32_t get(std::uint32_t offset, Picoseconds now) {
    std::uint32_t value = 0;
    EXPECT_TRUE(timer.load(offset, now, value));
    return value;
  }
  /// Timer 1 counts from 10 to 19. Its channel 2 compares with 13 and raises event 0.
  void begin(std::uint32_t config, std::uint32_t operation) {
    set(0x40 + 0x04, config);
    set(0x40 + 0x08, 19U << 16 | 10);
    set(0x40 + 0x0C + 8, operation | 13);
    set(0x100, 1U << 16 | (1 * 4 + 2));
    set(0x104, 1U << 1);
    set(0x40, 1);
  }
  void run(std::int64_t ticks) {
    while (timer.next_event() <= ticks * kTick) timer.advance(timer.next_event());
  }

  gap8_devices::Signals signals;
  double clock_hz = 100e6;
  std::vector<std::string> complaints;
  gap8_devices::AdvancedTimer timer{signals, [this] { return clock_hz; },
                                    [this](const char* text) { complaints.emplace_back(text); }};
  std::vector<std::pair<unsigned, std::int64_t>> heard;
};

TEST_F(Gap8AdvancedTimer, CountsBetweenItsLimitsAndRestartsOrReverses) {
  begin(kSaw, kSetThenClear);
  EXPECT_EQ(get(0x40 + 0x2C, 0), 10U);
  EXPECT_EQ(get(0x40 + 0x2C, 9 * kTick), 19U);
  EXPECT_EQ(get(0x40 + 0x2C, 10 * kTick), 10U);
  set(0x40 + 0x04, 0, 10 * kTick);
  EXPECT_EQ(get(0x40 + 0x2C, 20 * kTick), 10U) << "what is stored holds from an update on";
  set(0x40, 4 | 8, 20 * kTick);
  EXPECT_EQ(get(0x40 + 0x2C, 29 * kTick), 19U);
  EXPECT_EQ(get(0x40 + 0x2C, 30 * kTick), 18U);
  EXPECT_EQ(get(0x40 + 0x2C, 38 * kTick), 10U);
  set(0x40, 2, 38 * kTick);
  EXPECT_EQ(get(0x40 + 0x2C, 99 * kTick), 10U) << "stopped";
}

TEST_F(Gap8AdvancedTimer, RaisesTheEventOfAChannelWhoseOutputRises) {
  begin(kSaw, kSetThenClear);
  run(25);
  EXPECT_THAT(heard, ElementsAre(Pair(38U, 3), Pair(38U, 13), Pair(38U, 23)));
  heard.clear();
  set(0x40 + 0x0C + 8, kClearThenSet | 13, 25 * kTick);
  set(0x40, 4, 25 * kTick);
  run(45);
  EXPECT_THAT(heard, ElementsAre(Pair(38U, 29), Pair(38U, 39))) << "at the end of its period";
  heard.clear();
  set(0x100, 0, 45 * kTick);
  EXPECT_EQ(timer.next_event(), kNever);
}

TEST_F(Gap8AdvancedTimer, TogglesRiseEverySecondTimeAndATriangleMatchesTwice) {
  begin(kSaw, kToggle);
  run(45);
  EXPECT_THAT(heard, ElementsAre(Pair(38U, 3), Pair(38U, 23), Pair(38U, 43)));
  heard.clear();
  set(0x40 + 0x04, 0, 45 * kTick);
  set(0x40, 4 | 8, 45 * kTick);
  run(45 + 40);
  EXPECT_THAT(heard, ElementsAre(Pair(38U, 45 + 3), Pair(38U, 45 + 3 + 18), Pair(38U, 45 + 3 + 36)));
}

TEST_F(Gap8AdvancedTimer, KeepsItsCountAtAChangeOfClock) {
  begin(kSaw | 4U << 16, kSetThenClear);  // one tick in five clocks
  signals.clock_changes(10 * kTick);
  clock_hz = 50e6;
  EXPECT_EQ(get(0x40 + 0x2C, 10 * kTick), 12U);
  EXPECT_EQ(get(0x40 + 0x2C, 20 * kTick), 13U);
  run(200);
  EXPECT_THAT(heard, ElementsAre(Pair(38U, 20), Pair(38U, 120)));
}

TEST_F(Gap8AdvancedTimer, KeepsTheElapsedPartOfATickAtAChangeOfClock) {
  begin(kSaw | 9U << 16, kSetThenClear);  // one tick in ten clocks
  signals.clock_changes(25 * kTick);
  clock_hz = 1e9;
  EXPECT_EQ(get(0x40 + 0x2C, 25 * kTick), 12U) << "no tick has passed meanwhile";
  EXPECT_EQ(get(0x40 + 0x2C, 25 * kTick + 4'999), 12U);
  EXPECT_EQ(get(0x40 + 0x2C, 25 * kTick + 5'000), 13U) << "half of a tick was left";
}

TEST_F(Gap8AdvancedTimer, RaisesNoEventForEdgesBeforeItWasEnabled) {
  begin(kSaw, kSetThenClear);
  set(0x100, 0);
  set(0x40 + 0x0C, 0, 25 * kTick);
  EXPECT_EQ(timer.next_event(), kNever);
  set(0x100, 1U << 16 | (1 * 4 + 2), 25 * kTick);
  EXPECT_EQ(timer.next_event(), 33 * kTick);
  run(45);
  EXPECT_THAT(heard, ElementsAre(Pair(38U, 33), Pair(38U, 43)));
}

TEST_F(Gap8AdvancedTimer, CountsDuringStoresMoreFrequentThanItsTicks) {
  begin(kSaw, kSetThenClear);
  for (Picoseconds now = 0; now <= 25 * kTick; now += kTick / 4) {
    set(0x40 + 0x0C, 0, now);                      // changes a channel without an event
    set(0x104, 1U << 1 | (now / kTick & 1), now);  // changes another timer's enable bit
    set(0x40, 1, now);                             // starts the timer again while it is running
    ASSERT_EQ(get(0x40 + 0x2C, now), 10 + static_cast<std::uint32_t>(now / kTick % 10)) << now;
  }
  EXPECT_THAT(heard, ElementsAre(Pair(38U, 3), Pair(38U, 13), Pair(38U, 23)));
}

TEST_F(Gap8AdvancedTimer, ReportsThatInputPadsAreNotModelledAndKeepsItsState) {
  begin(kSaw | 3U << 8, kSetThenClear);
  EXPECT_EQ(complaints.size(), 1U);
  begin(kSaw | 3U << 8, kSetThenClear);
  EXPECT_EQ(complaints.size(), 1U) << "once";
  set(0x80 + 0x04, 3U << 8);
  EXPECT_EQ(complaints.size(), 2U) << "of each timer";
  run(15);
  gap8_devices::AdvancedTimer other(
      signals, [this] { return clock_hz; }, [](const char*) {});
  state::restore(other, state::save(timer));
  EXPECT_TRUE(mebots::test::same_state(timer, other));
  EXPECT_EQ(other.next_event(), timer.next_event());
  std::uint32_t value = 0;
  EXPECT_FALSE(timer.load(0x200, 0, value));
}

}  // namespace
}  // namespace mebots::soc::test
