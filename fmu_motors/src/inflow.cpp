// SPDX-License-Identifier: Apache-2.0
#include "inflow.hpp"

#include "mebots/assert.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mebots::motors {
namespace {

double climb_within_theory(const Inflow& inflow) {
  return std::max(inflow.climb_m_per_s, -inflow.hover_velocity());
}

}  // namespace

double Inflow::hover_velocity() const {
  MEBOTS_ASSERT(thrust_n >= 0 && density_kg_per_m3 > 0 && radius_m > 0);
  return std::sqrt(thrust_n / (2 * density_kg_per_m3 * std::numbers::pi * radius_m * radius_m));
}

double Inflow::induced_velocity() const {
  const double square = hover_velocity() * hover_velocity();
  if (square == 0) return 0;
  const double climb = climb_within_theory(*this);
  // Bisects, because v_i sqrt(V^2 + (V_c + v_i)^2) rises with v_i.
  double low = std::max(0.0, -climb);
  double high = std::sqrt(square) + std::abs(climb);
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    const double through = climb + middle;
    (middle * std::sqrt(speed_m_per_s * speed_m_per_s + through * through) < square ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double Inflow::power_beyond_hover_w() const {
  return thrust_n * (climb_within_theory(*this) + induced_velocity() - hover_velocity());
}

}  // namespace mebots::motors
