// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "devices/gap8/signals.hpp"
#include "mebots/soc/device.hpp"

#include <cstdint>

namespace mebots::soc::gap8_devices {

/// Models GAP8's real-time clock by Dolphin. Ticks, one per second after reset, drive its calendar, alarm and
/// countdown. Calendar and alarm use BCD. The registers are accessed through a window: a store into CTRL copies a
/// register from or to DATA, without delay. The copy, the alarm and the countdown each raise a SoC event.
///
/// Sources: archi/vendors/dolphin/rtc.h and rtc_periph.h of GreenWaves' gap_sdk; effect of a tick, and reset values:
/// GVSoC's model there (rtc_impl.cpp). Our addition: leap years from 2000 to 2099, as in the driver's calculation.
class Rtc final : public Device {
 public:
  explicit Rtc(Signals& signals) : signals_(signals) { reset(); }

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override;
  void visit(state::Visitor& v) override;

 private:
  void reset();
  void access(std::uint32_t control, Picoseconds now);
  std::uint32_t* reg(std::uint32_t number);
  void keep(std::uint32_t number, Picoseconds now);
  bool is_active() const { return (control_ & 1U) == 0; }
  Picoseconds tick_time(std::int64_t tick) const;
  void restart(Picoseconds now);
  void tick(Picoseconds time);
  void move_calendar();
  bool alarm_is_now() const;
  void raise(std::uint32_t flag, Picoseconds time);

  Signals& signals_;
  // The window: registers through which programs access the registers below.
  std::uint32_t data_ = 0;
  std::uint32_t window_mask_ = 0;
  std::uint32_t window_flags_ = 0;
  // Registers that are accessed through the window.
  std::uint32_t control_ = 0;
  std::uint32_t clock_control_ = 0;
  std::uint32_t irq_control_ = 0;
  std::uint32_t mask_ = 0;
  std::uint32_t flags_ = 0;
  std::uint32_t calendar_control_ = 0;
  std::uint32_t time_ = 0;
  std::uint32_t date_ = 0;
  std::uint32_t alarm_control_ = 0;
  std::uint32_t alarm_time_ = 0;
  std::uint32_t alarm_date_ = 0;
  std::uint32_t countdown_control_ = 0;
  std::uint32_t countdown_init_ = 0;
  std::uint32_t countdown_ = 0;
  std::uint32_t divider_ = 0;       // divider that was stored last
  std::int64_t edges_of_tick_ = 1;  // divider with which the ticks were started
  std::int64_t first_edge_ = 0;     // edge of the reference clock at which the ticks were started
  std::int64_t ticks_ = 0;          // number of ticks since `first_edge_`
};

}  // namespace mebots::soc::gap8_devices
