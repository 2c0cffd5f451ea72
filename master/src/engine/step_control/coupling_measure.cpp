// SPDX-License-Identifier: Apache-2.0
#include "engine/step_control/coupling_measure.hpp"

#include "base/time.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace mebots::master {

CouplingMeasure::CouplingMeasure(const ResolvedSystem& system, Ensemble& ensemble)
    : grid_(system.description->grid()),
      max_step_s_(to_seconds(system.description->length_of(system.description->step_control->max_steps))) {
  for (const auto& measured : system.step_control->measured) {
    auto& item = items_.emplace_back();
    item.tolerance = measured.tolerance;
    if (measured.bond != nullptr) {
      item.bond.emplace(system, ensemble, *measured.bond);
      continue;
    }
    const auto& connection = system.connections[measured.connection];
    item.input.emplace(ensemble, connection);
    item.nominal = std::abs(connection.to.variable->nominal.value_or(1));
  }
}

/// Measures the error of an input or a bond. Returns nullopt if no step of the output's instance, or of the bond's
/// instances, ends at this point.
std::optional<CouplingMeasure::Measured> CouplingMeasure::measure(const Item& item, const Point& point) const {
  if (item.bond) {
    const auto energy = item.bond->energy(point, grid_);
    if (!energy) return std::nullopt;
    return Measured{.error = std::abs(energy->made), .magnitude = energy->passed / energy->length_s};
  }
  if (!item.input->is_reached(point.time_ns) || !item.input->start_ns()) return std::nullopt;
  return Measured{.error = item.input->deviation_integral(point.time_ns, grid_),
                  .magnitude = std::abs(item.input->value())};
}

CouplingMeasure::Error CouplingMeasure::error(const Point& point) const {
  Error error;
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const auto& item = items_[i];
    const auto measured = measure(item, point);
    if (!measured || measured->error == 0) continue;
    const double tolerance =
        item.tolerance.relative * std::max(item.largest, measured->magnitude) + item.tolerance.absolute * item.nominal;
    const double over = measured->error / (tolerance * max_step_s_);
    if (over <= error.over_tolerance) continue;
    const int order_of_deviation = item.bond ? item.bond->order() : item.input->order();
    error = {.over_tolerance = over, .order = order_of_deviation + 1, .worst = i};
  }
  return error;
}

void CouplingMeasure::advance(const Point& point) {
  for (auto& item : items_) {
    if (const auto measured = measure(item, point)) item.largest = std::max(item.largest, measured->magnitude);
    if (item.bond) {
      item.bond->advance(point, grid_);
    } else if (item.input->is_reached(point.time_ns)) {
      item.input->advance(point.time_ns, grid_);
    }
  }
}

void CouplingMeasure::Item::visit(state::Visitor& v) {
  if (input) v("input", *input);
  if (bond) v("bond", *bond);
  v("largest", largest);
}

void CouplingMeasure::visit(state::Visitor& v) {
  v("items", std::span(items_));
}

}  // namespace mebots::master
