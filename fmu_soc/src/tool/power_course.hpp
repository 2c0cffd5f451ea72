// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "soc/soc.hpp"
#include "soc/state_times.hpp"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace mebots::soc::tool {

/// Minimum, maximum and mean of a core's clock over the time in which the core has power.
class ClockRange {
 public:
  void add(double hz, Picoseconds span);
  /// Returns true if the core has had power. Otherwise the functions below must not be called.
  bool has_run() const { return span_ > 0; }
  double least_hz() const { return least_hz_; }
  double most_hz() const { return most_hz_; }
  double mean_hz() const { return ticks_ / span_; }

 private:
  double least_hz_ = 0;
  double most_hz_ = 0;
  double ticks_ = 0;  // sum of clock [Hz] times duration [ps]
  double span_ = 0;
};

/// Records over time: energy of each part and device, time in each state, and clocks.
///
/// An event adds a point, but at most one point per interval. If there are too many points, every second point is
/// deleted, and the interval is doubled. Values are totals since the start, so that differences between points are
/// exact.
class PowerCourse final : public StateListener {
 public:
  static constexpr std::size_t kMost = 2048;

  struct Point {
    Picoseconds time = 0;
    std::vector<double> parts_j;    ///< in the order of the chip's parts
    std::vector<double> devices_j;  ///< in the order of devices()
    std::array<Picoseconds, StateTimes::kCounted> in_state{};
  };

  /// `soc` must outlive this object.
  explicit PowerCourse(const Soc& soc);

  void changed(Picoseconds time) override;
  /// Must be called at the end of the run.
  void finish();

  /// Returns the names of the devices that have states with power.
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
  Picoseconds spacing_ = 1'000'000;  // interval between two points, at first 1 us
  ClockRange controller_clock_;
  ClockRange cluster_clock_;
  // Clocks at the last call of add_clocks(). The clock of a core without power is 0.
  Picoseconds clocks_since_ = 0;
  double controller_hz_ = 0;
  double cluster_hz_ = 0;
};

}  // namespace mebots::soc::tool
