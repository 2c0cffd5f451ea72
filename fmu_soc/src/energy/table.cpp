// SPDX-License-Identifier: Apache-2.0
#include "energy/table.hpp"

#include "mebots/data/object.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace mebots::soc {
namespace {

struct Point {
  double where = 0;
  data::Node node;
};

/// Returns the number in the key of a member. Keys in JSON are texts.
double number_of(const data::Member& member) {
  std::size_t used = 0;
  double value = 0;
  try {
    value = std::stod(member.key, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used == 0 || used != member.key.size() || !std::isfinite(value)) {
    member.value.fail(ErrorCode::invalid_value, fmt::format("'{}' must be a number, the point of an axis", member.key));
  }
  return value;
}

/// Returns the points of an axis, each with its node in the file, sorted by value. Reports an axis without points, and
/// a point that occurs twice.
std::vector<Point> sorted_points(const data::Node& node) {
  std::vector<Point> points;
  for (const auto& member : node.members()) {
    member.value.attempt([&] { points.push_back({member.key == "any" ? 0.0 : number_of(member), member.value}); });
  }
  if (node.members().empty()) node.fail(ErrorCode::invalid_value, "there is no point on this axis");
  std::ranges::stable_sort(points, {}, &Point::where);
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (points[i].where == points[i - 1].where) {
      points[i].node.complain(ErrorCode::duplicate_key, "this point occurs twice on its axis");
    }
  }
  return points;
}

/// Calls take(where, node) for each point of an axis. Reports errors that `take` throws as mistakes at the node.
template <typename Take>
void for_each_point(const data::Node& axis, const Take& take) {
  for (const auto& point : sorted_points(axis)) {
    point.node.attempt([&] { take(point.where, point.node); });
  }
}

/// Interpolates at `where` on an axis. `figure_at(index)` returns the value at a point of the axis.
template <typename FigureAt>
double between(const std::vector<double>& axis, double where, const std::string& table, std::string_view what,
               const FigureAt& figure_at) {
  if (axis.size() == 1) return figure_at(0);
  const auto above = std::upper_bound(axis.begin(), axis.end(), where);
  if (where < axis.front() || where > axis.back()) {
    throw Error(ErrorCode::value_out_of_range,
                fmt::format("{} covers {} to {} {}, not {}", table, axis.front(), axis.back(), what, where));
  }
  const auto high = above == axis.end() ? axis.size() - 1 : static_cast<std::size_t>(above - axis.begin());
  const auto low = high - 1;
  const auto share = (where - axis[low]) / (axis[high] - axis[low]);
  const auto lower = figure_at(low);
  return lower + share * (figure_at(high) - lower);
}

}  // namespace

EnergyTable EnergyTable::read(const data::Node& node, std::string_view unit, double scale) {
  EnergyTable table;
  data::Object object(node);
  data::read_unit(object, unit);
  data::read_source(object);
  object.read("values", table, [&](const data::Node& values) { return read_values(values, scale); });
  object.finish();
  return table;
}

EnergyTable EnergyTable::read_values(const data::Node& values, double scale) {
  EnergyTable table;
  table.name_ = values.place();
  for_each_point(values, [&](double temperature_c, const data::Node& by_voltage) {
    table.temperatures_c_.push_back(temperature_c);
    Surface& surface = table.surfaces_.emplace_back();
    for_each_point(by_voltage, [&](double voltage_v, const data::Node& by_clock) {
      surface.voltages_v.push_back(voltage_v);
      Curve& curve = surface.curves.emplace_back();
      for_each_point(by_clock, [&](double clock_hz, const data::Node& figure) {
        curve.clocks_hz.push_back(clock_hz);
        curve.figures.push_back(scale * figure.number(data::Limits::at_least(0)));
      });
    });
  });
  return table;
}

double EnergyTable::at(const OperatingPoint& point) const {
  return between(temperatures_c_, point.temperature_c, name_, "degC", [&](std::size_t t) {
    const auto& surface = surfaces_[t];
    return between(surface.voltages_v, point.voltage_v, name_, "V", [&](std::size_t v) {
      const auto& curve = surface.curves[v];
      return between(curve.clocks_hz, point.clock_hz, name_, "Hz", [&](std::size_t f) { return curve.figures[f]; });
    });
  });
}

}  // namespace mebots::soc
