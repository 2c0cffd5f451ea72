// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gap8_devices/signals.hpp"
#include "mebots/soc/device.hpp"

#include <array>
#include <cstdint>
#include <functional>

namespace mebots::soc::gap8_devices {

/// GAP8's timer: two counters of 32 bits, of the fabric controller's clock or of the reference clock. Each has a
/// comparison that raises an event, starts it anew, or stops it; or both as one of 64 bits. Source:
/// archi/timer/timer_v2.h.
class Timer final : public Device {
 public:
  /// `clock_hz`: of the fabric controller, now.
  Timer(Signals& signals, std::function<double()> clock_hz);

  bool load(std::uint32_t offset, Picoseconds now, std::uint32_t& value) override;
  bool store(std::uint32_t offset, Picoseconds now, std::uint32_t value) override;
  void advance(Picoseconds now) override;
  Picoseconds next_event() const override;
  void visit(state::Visitor& v) override;

 private:
  struct Counter {
    std::uint32_t config = 0;
    std::uint32_t compare = 0;
    std::uint64_t value = 0;        // at `since`; the low counter of a pair holds both
    std::uint64_t compared_at = 0;  // the value at which the comparison was last met
    bool met = false;               // and it has not moved on since
    Picoseconds since = 0;

    void visit(state::Visitor& v) {
      v("config", config);
      v("compare", compare);
      v("value", value);
      v("compared_at", compared_at);
      v("met", met);
      v("since", since);
    }
  };

  bool is_pair() const;
  std::uint64_t ticks(const Counter& counter, Picoseconds from, Picoseconds to) const;
  Picoseconds time_of(const Counter& counter, std::uint64_t ticks) const;
  std::uint64_t width_mask() const { return is_pair() ? ~std::uint64_t{0} : 0xffffffffU; }
  std::uint64_t target_of(unsigned index) const;
  void count(unsigned index, Picoseconds now);
  void count_all(Picoseconds now);
  void compare(unsigned index);
  void configure(unsigned index, std::uint32_t config);

  Signals& signals_;
  std::function<double()> clock_hz_;
  std::array<Counter, 2> counters_;
};

}  // namespace mebots::soc::gap8_devices
