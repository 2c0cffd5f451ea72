// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "soc/soc.hpp"
#include "soc/state_times.hpp"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace mebots::soc::tool {

/// Minimum, maximum and mean of a core's clock, over the time in which the core has power.
class ClockRange {
 public:
  /// Adds a span of time at a clock.
  void add(double hz, Picoseconds span);
  /// Returns whether the core has had power for some time. If false, the functions below must not be called.
  bool has_run() const { return span_ > 0; }
  double least_hz() const { return least_hz_; }
  double most_hz() const { return most_hz_; }
  /// Returns the mean over time.
  double mean_hz() const { return ticks_ / span_; }

 private:
  double least_hz_ = 0;
  double most_hz_ = 0;
  double ticks_ = 0;  // sum of hz times picoseconds
  double span_ = 0;
};

/// Records in memory, over the time of a run: the energy of each part and device, the time in each state, and the
/// clocks.
///
/// At an event, a point is added, but at most one point per interval. If there are too many points, every second point
/// is dropped, and the interval is doubled. Values are totals since the start, so their differences remain exact.
class PowerCourse final : public StateListener {
 public:
  static constexpr std::size_t kMost = 2048;

  struct Point {
    Picoseconds time = 0;
    std::vector<double> parts_j;    ///< in the order of the chip's parts
    std::vector<double> devices_j;  ///< in the order of devices()
    std::array<Picoseconds, StateTimes::kCounted> in_state{};
  };

  /// The chip must outlive this object.
  explicit PowerCourse(const Soc& soc);

  void changed(Picoseconds time) override;
  /// Adds the last point of the run.
  void finish();

  /// Names of the devices that have states with power.
  const std::vector<std::string>& devices() const { return devices_; }
  const std::vector<Point>& points() const { return points_; }
  const ClockRange& controller_clock() const { return controller_clock_; }
  const ClockRange& cluster_clock() const { return cluster_clock_; }

 private:
  void add(Picoseconds time);
  void halve();
  void add_clocks(Picoseconds time);

  const Soc& soc_;
  std::vector<std::string> devices_;
  std::vector<Point> points_;
  Picoseconds spacing_ = 1'000'000;  // 1 us
  ClockRange controller_clock_;
  ClockRange cluster_clock_;
  // The clocks that were read at the last call of add_clocks(). The clock of a core without power is 0.
  Picoseconds clocks_since_ = 0;
  double controller_hz_ = 0;
  double cluster_hz_ = 0;
};

}  // namespace mebots::soc::tool
