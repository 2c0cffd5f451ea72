// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "soc/soc.hpp"
#include "soc/state_times.hpp"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace mebots::soc::tool {

/// Energy of each part and device, and time in each state, over the time of a run, in memory.
///
/// A point is taken at an event, but at most one point in each interval of the present spacing. If there are too many
/// points, every second one is dropped, and the spacing doubles. Values are totals since the start, so their
/// differences remain exact.
class PowerCourse final : public StateListener {
 public:
  static constexpr std::size_t kMost = 2048;

  struct Point {
    Picoseconds time = 0;
    std::vector<double> parts_j;    ///< in the order of the chip's parts
    std::vector<double> devices_j;  ///< in the order of devices()
    std::array<Picoseconds, StateTimes::kCounted> in_state{};
  };

  /// The chip must outlive it.
  explicit PowerCourse(const Soc& soc);

  void changed(Picoseconds time) override;
  /// Adds the last point of the run.
  void finish();

  /// Names of the devices that have states with power.
  const std::vector<std::string>& devices() const { return devices_; }
  const std::vector<Point>& points() const { return points_; }

 private:
  void add(Picoseconds time);
  void halve();

  const Soc& soc_;
  std::vector<std::string> devices_;
  std::vector<Point> points_;
  Picoseconds spacing_ = 1'000'000;  // 1 us
};

}  // namespace mebots::soc::tool
