// SPDX-License-Identifier: Apache-2.0
#include "scene/path.hpp"

#include "mebots/assert.hpp"

#include <algorithm>

namespace mebots::world::scene {

double Path::reach_m() const {
  double reach_m = 0.0;
  for (const Point& point : points) reach_m = std::max(reach_m, point.offset_W_m.norm());
  return reach_m;
}

Displacement Path::at(std::int64_t time_ns) const {
  if (!moves()) return {};
  MEBOTS_ASSERT(points.size() >= 2 && points.front().time_ns == 0);
  const std::int64_t end_ns = points.back().time_ns;
  // In whole nanoseconds: the thousandth round is as exact as the first.
  const std::int64_t now_ns = repeat ? std::max<std::int64_t>(time_ns, 0) % end_ns : std::max<std::int64_t>(time_ns, 0);
  if (now_ns >= end_ns) return {points.back().offset_W_m, points.back().turn_rad, Eigen::Vector3d::Zero(), 0.0};
  const auto next = std::upper_bound(points.begin() + 1, points.end(), now_ns,
                                     [](std::int64_t time, const Point& point) { return time < point.time_ns; });
  const Point& a = *(next - 1);
  const Point& b = *next;
  const double span_s = static_cast<double>(b.time_ns - a.time_ns) * 1e-9;
  const double share = static_cast<double>(now_ns - a.time_ns) / static_cast<double>(b.time_ns - a.time_ns);
  const Eigen::Vector3d way_m = b.offset_W_m - a.offset_W_m;
  const double turn_rad = b.turn_rad - a.turn_rad;
  return {a.offset_W_m + share * way_m, a.turn_rad + share * turn_rad, way_m / span_s, turn_rad / span_s};
}

}  // namespace mebots::world::scene
