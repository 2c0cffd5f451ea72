// SPDX-License-Identifier: Apache-2.0
#include "devices/gap8/rtc.hpp"

#include "devices/core/kinds.hpp"

#include <algorithm>
#include <array>

namespace mebots::soc::gap8_devices {
namespace {

constexpr std::uint32_t kWindowStatus = 0x00;
constexpr std::uint32_t kWindowControl = 0x04;
constexpr std::uint32_t kWindowData = 0x08;
constexpr std::uint32_t kWindowMask = 0x14;
constexpr std::uint32_t kWindowFlags = 0x18;
constexpr std::uint32_t kNumberMask = 0x3f;
constexpr std::uint32_t kWrites = 1U << 16;
constexpr std::uint32_t kReadDone = 1U << 0;
constexpr std::uint32_t kWriteDone = 1U << 1;

constexpr unsigned kWindowEvent = 43;
constexpr unsigned kRtcEvent = 44;

enum RtcNumber : std::uint32_t {
  kRtcStatus = 0x00,
  kRtcControl = 0x01,
  kClockControl = 0x02,
  kRtcIrqControl = 0x08,
  kRtcIrqMask = 0x09,
  kRtcIrqFlag = 0x0A,
  kCalendarControl = 0x10,
  kCalendarTime = 0x12,
  kCalendarDate = 0x13,
  kAlarmControl = 0x18,
  kAlarmTime = 0x1A,
  kAlarmDate = 0x1B,
  kCountdownControl = 0x20,
  kCountdownInit = 0x21,
  kCountdownTimer = 0x22,
  kDivider = 0x28,
};
constexpr std::uint32_t kSoftReset = 1U << 8;
constexpr std::uint32_t kRtcOff = 1U << 0;      // switches calendar, alarm and countdown off
constexpr std::uint32_t kRtcRepeats = 1U << 4;  // repeats alarm or countdown
constexpr std::uint32_t kAlarmFlag = 1U << 0;
constexpr std::uint32_t kCountdownFlag = 1U << 4;

constexpr std::uint32_t kDividerAtReset = 0x8000;
constexpr std::uint32_t kAlarmAtReset = 0x00660003;
// 1 January 2000, our choice; in GVSoC, the date depends on the board.
constexpr std::uint32_t kDateAtReset = 0x00000101;

/// Returns the number in the two BCD digits that start at bit `from`.
std::uint32_t digits(std::uint32_t word, unsigned from) {
  return (word >> from & 0xfU) + 10 * (word >> (from + 4) & 0xfU);
}
std::uint32_t as_digits(std::uint32_t number, unsigned at) {
  return (number % 10 | number / 10 % 10 << 4) << at;
}

std::uint32_t days_of(std::uint32_t month, std::uint32_t year) {
  static constexpr std::array<std::uint32_t, 13> kDays{31, 31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  if (month == 2 && year % 4 == 0) return 29;
  return kDays[std::min<std::size_t>(month, kDays.size() - 1)];
}

}  // namespace

void Rtc::reset() {
  control_ = 0;
  calendar_control_ = 0;
  time_ = 0;
  date_ = kDateAtReset;
  alarm_control_ = kAlarmAtReset;
  alarm_time_ = 0;
  alarm_date_ = 0;
  countdown_control_ = kRtcOff;
  countdown_init_ = 0xffffffffU;
  countdown_ = 0xffffffffU;
  divider_ = kDividerAtReset;
  edges_of_tick_ = kDividerAtReset;
}

bool Rtc::load(std::uint32_t offset, Picoseconds /*now*/, std::uint32_t& value) {
  switch (offset) {
    case kWindowStatus:
      value = (window_flags_ & ~window_mask_) != 0 ? 1 : 0;
      return true;
    case kWindowControl:
      value = 0;
      return true;
    case kWindowData:
      value = data_;
      return true;
    case kWindowMask:
      value = window_mask_;
      return true;
    case kWindowFlags:
      value = window_flags_;
      return true;
    default:
      value = 0;
      return offset < kWindowFlags;  // IRQ_CTRL has no visible effect
  }
}

bool Rtc::store(std::uint32_t offset, Picoseconds now, std::uint32_t value) {
  switch (offset) {
    case kWindowControl:
      access(value, now);
      return true;
    case kWindowData:
      data_ = value;
      return true;
    case kWindowMask:
      window_mask_ = value;
      return true;
    case kWindowFlags:
      window_flags_ &= ~value;
      return true;
    default:
      return offset < kWindowFlags;
  }
}

std::uint32_t* Rtc::reg(std::uint32_t number) {
  switch (number) {
    case kRtcControl:
      return &control_;
    case kClockControl:
      return &clock_control_;
    case kRtcIrqControl:
      return &irq_control_;
    case kRtcIrqMask:
      return &mask_;
    case kRtcIrqFlag:
      return &flags_;
    case kCalendarControl:
      return &calendar_control_;
    case kCalendarTime:
      return &time_;
    case kCalendarDate:
      return &date_;
    case kAlarmControl:
      return &alarm_control_;
    case kAlarmTime:
      return &alarm_time_;
    case kAlarmDate:
      return &alarm_date_;
    case kCountdownControl:
      return &countdown_control_;
    case kCountdownInit:
      return &countdown_init_;
    case kCountdownTimer:
      return &countdown_;
    case kDivider:
      return &divider_;
    default:
      return nullptr;
  }
}

void Rtc::access(std::uint32_t control, Picoseconds now) {
  advance(now);
  const auto number = control & kNumberMask;
  const bool writes = (control & kWrites) != 0;
  auto* const found = reg(number);
  if (!writes) {
    data_ = number == kRtcStatus ? ((flags_ & ~mask_) != 0 ? 1U : 0U) : found != nullptr ? *found : 0;
  } else if (number == kRtcIrqFlag) {
    flags_ &= ~data_;
  } else if (found != nullptr) {
    *found = data_;
    keep(number, now);
  }
  const auto done = writes ? kWriteDone : kReadDone;
  window_flags_ |= done;
  if ((window_mask_ & done) == 0) signals_.raise_soc_event(kWindowEvent, now);
}

void Rtc::keep(std::uint32_t number, Picoseconds now) {
  if (number == kRtcControl) {
    if ((control_ & kSoftReset) != 0) reset();
    restart(now);
  } else if (number == kCountdownInit) {
    countdown_ = countdown_init_;
  } else if (number == kDivider) {
    divider_ &= 0xffffU;  // the divider is used at the next restart
  } else if (number == kRtcIrqMask && (flags_ & ~mask_) != 0) {
    signals_.raise_soc_event(kRtcEvent, now);
  }
}

/// Restarts the count of ticks with the present divider.
void Rtc::restart(Picoseconds now) {
  edges_of_tick_ = std::max<std::int64_t>(divider_, 1);
  first_edge_ = reference_edges(now);
  ticks_ = 0;
}

Picoseconds Rtc::tick_time(std::int64_t tick) const {
  return reference_edge_time(first_edge_ + tick * edges_of_tick_);
}

/// Returns the next tick that may raise an event. Other ticks have no visible effect.
Picoseconds Rtc::next_event() const {
  if (!is_active()) return kNever;
  if ((alarm_control_ & kRtcOff) == 0) return tick_time(ticks_ + 1);
  if ((countdown_control_ & kRtcOff) == 0) return tick_time(ticks_ + 1 + countdown_);
  return kNever;
}

void Rtc::advance(Picoseconds now) {
  while (is_active() && tick_time(ticks_ + 1) <= now) {
    ++ticks_;
    tick(tick_time(ticks_));
  }
}

void Rtc::tick(Picoseconds time) {
  if ((calendar_control_ & kRtcOff) == 0) move_calendar();
  if ((alarm_control_ & kRtcOff) == 0 && alarm_is_now()) {
    if ((alarm_control_ & kRtcRepeats) == 0) alarm_control_ |= kRtcOff;
    raise(kAlarmFlag, time);
  }
  if ((countdown_control_ & kRtcOff) != 0) return;
  if (countdown_-- != 0) return;
  if ((countdown_control_ & kRtcRepeats) != 0) {
    countdown_ = countdown_init_;
  } else {
    countdown_control_ |= kRtcOff;
  }
  raise(kCountdownFlag, time);
}

void Rtc::move_calendar() {
  auto second = digits(time_, 0) + 1;
  auto minute = digits(time_, 8) + second / 60;
  auto hour = digits(time_, 16) + minute / 60;
  auto day = digits(date_, 0) + hour / 24;
  auto month = digits(date_, 8);
  auto year = digits(date_, 16);
  if (day > days_of(month, year)) {
    day = 1;
    ++month;
  }
  if (month > 12) {
    month = 1;
    year = (year + 1) % 100;
  }
  time_ = as_digits(second % 60, 0) | as_digits(minute % 60, 8) | as_digits(hour % 24, 16);
  date_ = as_digits(day, 0) | as_digits(month, 8) | as_digits(year, 16);
}

/// Returns true if the alarm time is reached. A single alarm compares date and time. A repeating alarm compares the
/// configured number of fields, from 4 (seconds) to 8 (all fields up to the month).
bool Rtc::alarm_is_now() const {
  if ((alarm_control_ & kRtcRepeats) == 0) return time_ == alarm_time_ && date_ == alarm_date_;
  const auto fields = (alarm_control_ >> 16 & 0xfU);
  if (fields < 4 || fields > 8) return true;
  const auto of_time = std::min<std::uint32_t>(fields - 3, 3) * 8;
  const auto of_date = fields > 6 ? (fields - 6) * 8 : 0;
  const auto differs = [](std::uint32_t one, std::uint32_t other, std::uint32_t bits) {
    return ((one ^ other) & ((1U << bits) - 1)) != 0;
  };
  return !differs(time_, alarm_time_, of_time) && !differs(date_, alarm_date_, of_date);
}

void Rtc::raise(std::uint32_t flag, Picoseconds time) {
  const bool is_new = (flags_ & flag) == 0;
  flags_ |= flag;
  if (is_new && (mask_ & flag) == 0) signals_.raise_soc_event(kRtcEvent, time);
}

void Rtc::visit(state::Visitor& v) {
  v("data", data_);
  v("window_mask", window_mask_);
  v("window_flags", window_flags_);
  v("control", control_);
  v("clock_control", clock_control_);
  v("irq_control", irq_control_);
  v("mask", mask_);
  v("flags", flags_);
  v("calendar_control", calendar_control_);
  v("time", time_);
  v("date", date_);
  v("alarm_control", alarm_control_);
  v("alarm_time", alarm_time_);
  v("alarm_date", alarm_date_);
  v("countdown_control", countdown_control_);
  v("countdown_init", countdown_init_);
  v("countdown", countdown_);
  v("divider", divider_);
  v("edges_of_tick", edges_of_tick_);
  v("first_edge", first_edge_);
  v("ticks", ticks_);
}

}  // namespace mebots::soc::gap8_devices

MEBOTS_CHIP_KIND(gap8_rtc, {}, [](const BoardDevice& /*entry*/, ChipHost& host) -> std::unique_ptr<Device> {
  return std::make_unique<gap8_devices::Rtc>(host.signals());
})
