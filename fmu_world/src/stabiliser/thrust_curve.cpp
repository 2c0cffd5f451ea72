// SPDX-License-Identifier: Apache-2.0
#include "stabiliser/thrust_curve.hpp"

#include <algorithm>

namespace mebots::world {
namespace {

using Point = scene::ThrustPoint;

/// Value of `to` where `from` is x, on the table's broken line.
double between(const std::vector<Point>& points, double Point::*from, double Point::*to, double x) {
  const auto above = std::upper_bound(points.begin() + 1, points.end() - 1, x,
                                      [from](double value, const Point& point) { return value < point.*from; });
  const Point& b = *above;
  const Point& a = *(above - 1);
  return a.*to + (b.*to - a.*to) * (x - a.*from) / (b.*from - a.*from);
}

}  // namespace

double ThrustCurve::command_for(double thrust_n) const {
  return between(points_, &Point::thrust_n, &Point::command, thrust_n);
}

double ThrustCurve::thrust_for(double command) const {
  return between(points_, &Point::command, &Point::thrust_n, command);
}

}  // namespace mebots::world
