// SPDX-License-Identifier: Apache-2.0
#include "energy/table.hpp"

#include <algorithm>

namespace mebots::soc {
namespace {

/// Keys are numbers, written as JSON wants it: as text.
double number_of(const data::Node& node, const std::string& key) {
  std::size_t used = 0;
  double value = 0;
  try {
    value = std::stod(key, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used == 0 || used != key.size()) node.fail(key, "must be a number, the point of an axis");
  return value;
}

std::vector<std::pair<double, std::string>> sorted_keys(const data::Node& node) {
  std::vector<std::pair<double, std::string>> keys;
  for (const auto& key : node.keys()) keys.emplace_back(key == "any" ? 0.0 : number_of(node, key), key);
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (keys[i].first == keys[i - 1].first) node.fail(keys[i].second, "is a point that stands twice");
  }
  return keys;
}

/// Figure at `where` on an axis, each of its points' figures given by `figure_at(index)`.
template <typename FigureAt>
double between(const std::vector<double>& axis, double where, const std::string& table, std::string_view what,
               const FigureAt& figure_at) {
  if (axis.size() == 1) return figure_at(0);
  const auto above = std::upper_bound(axis.begin(), axis.end(), where);
  if (where < axis.front() || where > axis.back()) {
    throw Error(fmt::format("{} goes from {} to {} {}; asked for {}", table, axis.front(), axis.back(), what, where));
  }
  const auto high = above == axis.end() ? axis.size() - 1 : static_cast<std::size_t>(above - axis.begin());
  const auto low = high - 1;
  const auto share = (where - axis[low]) / (axis[high] - axis[low]);
  const auto lower = figure_at(low);
  return lower + share * (figure_at(high) - lower);
}

}  // namespace

EnergyTable::EnergyTable(const data::Node& node, std::string_view unit, double scale) {
  node.only({"unit", "source", "values"});
  node.require_unit(unit);
  if (node.text("source").empty()) node.fail("source", "is empty: say where the values come from");
  const auto values = node.object("values");
  name_ = values.name();
  for (const auto& [temperature_c, temperature_key] : sorted_keys(values)) {
    const auto by_voltage = values.object(temperature_key);
    Surface surface;
    for (const auto& [voltage_v, voltage_key] : sorted_keys(by_voltage)) {
      const auto by_clock = by_voltage.object(voltage_key);
      Curve curve;
      for (const auto& [clock_hz, clock_key] : sorted_keys(by_clock)) {
        curve.clocks_hz.push_back(clock_hz);
        curve.figures.push_back(scale * by_clock.number(clock_key, data::Limits::at_least(0)));
      }
      if (curve.figures.empty()) by_voltage.fail(voltage_key, "is empty");
      surface.voltages_v.push_back(voltage_v);
      surface.curves.push_back(curve);
    }
    if (surface.curves.empty()) values.fail(temperature_key, "is empty");
    temperatures_c_.push_back(temperature_c);
    surfaces_.push_back(surface);
  }
  if (surfaces_.empty()) node.fail("values", "is empty");
}

double EnergyTable::at(const OperatingPoint& point) const {
  return between(temperatures_c_, point.temperature_c, name_, "C", [&](std::size_t t) {
    const auto& surface = surfaces_[t];
    return between(surface.voltages_v, point.voltage_v, name_, "V", [&](std::size_t v) {
      const auto& curve = surface.curves[v];
      return between(curve.clocks_hz, point.clock_hz, name_, "Hz", [&](std::size_t f) { return curve.figures[f]; });
    });
  });
}

}  // namespace mebots::soc
