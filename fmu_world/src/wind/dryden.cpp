// SPDX-License-Identifier: Apache-2.0
#include "wind/dryden.hpp"

#include "math/periods.hpp"
#include "mebots/error.hpp"
#include "noise/counter_noise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mebots::world {
namespace {

constexpr std::int64_t kPeriod_ns = 10'000'000;
/// Limits of speed / length. Outside of these limits, the filters' coefficients are not finite or have too large
/// rounding errors.
constexpr double kSlowest_per_s = 1e-12;
constexpr double kFastest_per_s = 1e12;
constexpr int kNormals = 5;  // normal numbers per filter step
/// The least length [m] and speed [m/s], as in description.json.
constexpr double kLeast = 0.001;

}  // namespace

Dryden::Dryden(const Settings& settings) : settings_(settings) {
  const auto require = [](double value, const char* name, bool good, const char* limit) {
    if (!good || !std::isfinite(value))
      throw Error(fmt::format("{} = {} must be a finite number {}", name, value, limit));
  };
  require(settings.intensity_m_per_s, "gust.intensity", settings.intensity_m_per_s >= 0.0, ">= 0");
  require(settings.length_m, "gust.length", settings.length_m >= kLeast, ">= 0.001");
  require(settings.speed_m_per_s, "gust.speed", settings.speed_m_per_s >= kLeast, ">= 0.001");
  // With tau = L / V and unit variances, the filter along x is x' = (-x + n) / tau. For y and z, it is
  // x1' = (-x1 + n) / tau and x2' = (-x2 + x1) / tau with the output sqrt(3) x1 + (1 - sqrt(3)) x2. White noise n of
  // intensity tau gives this output a variance of 1.
  const double rate_per_s = settings.speed_m_per_s / settings.length_m;
  if (settings.intensity_m_per_s > 0.0 && !(rate_per_s >= kSlowest_per_s && rate_per_s <= kFastest_per_s)) {
    throw Error(
        fmt::format("gust.speed = {} m/s divided by gust.length = {} m is {:g} per s, but must be from {:g} to {:g}",
                    settings.speed_m_per_s, settings.length_m, rate_per_s, kSlowest_per_s, kFastest_per_s));
  }
  const double e = static_cast<double>(kPeriod_ns) * 1e-9 * settings.speed_m_per_s / settings.length_m;
  decay_ = std::exp(-e);
  share_ = e;
  const double square = decay_ * decay_;
  spread_x_ = std::sqrt(-std::expm1(-2.0 * e));
  const double q11 = 0.5 * (1.0 - square);
  const double q12 = 0.25 * (1.0 - (1.0 + 2.0 * e) * square);
  const double q22 = 0.25 * (1.0 - (1.0 + 2.0 * e + 2.0 * e * e) * square);
  root_[0] = std::sqrt(q11);
  root_[1] = q12 / root_[0];
  root_[2] = std::sqrt(std::max(0.0, q22 - root_[1] * root_[1]));
}

double Dryden::normal(std::int64_t index, std::size_t which) const {
  return noise::gaussian(settings_.seed, noise::Stream::gust, static_cast<std::uint64_t>(kNormals * index) + which);
}

void Dryden::begin(std::int64_t index) {
  along_ = normal(index, 0);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    // The filters start in their stationary distribution: the two states of a filter for y or z have the covariance
    // [1/2, 1/4; 1/4, 1/4].
    const double first = normal(index, 1 + 2 * axis);
    const double second = normal(index, 2 + 2 * axis);
    across_[2 * axis] = std::sqrt(0.5) * first;
    across_[2 * axis + 1] = 0.25 / std::sqrt(0.5) * first + std::sqrt(0.125) * second;
  }
  index_ = index;
}

void Dryden::step(std::int64_t index) {
  along_ = decay_ * along_ + spread_x_ * normal(index, 0);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double first = normal(index, 1 + 2 * axis);
    const double second = normal(index, 2 + 2 * axis);
    double& x1 = across_[2 * axis];
    double& x2 = across_[2 * axis + 1];
    x2 = decay_ * (x2 + share_ * x1) + root_[1] * first + root_[2] * second;
    x1 = decay_ * x1 + root_[0] * first;
  }
  index_ = index;
}

void Dryden::combine() {
  const double a = std::sqrt(3.0);
  const double b = 1.0 - a;
  gust_ = settings_.intensity_m_per_s *
          Eigen::Vector3d(along_, a * across_[0] + b * across_[1], a * across_[2] + b * across_[3]);
}

const Eigen::Vector3d& Dryden::at(std::int64_t time_ns) {
  if (settings_.intensity_m_per_s == 0.0) return gust_;
  const std::int64_t index = period_at(time_ns, kPeriod_ns);
  if (index == index_) return gust_;
  if (index_ == kNoPeriod) begin(index);
  while (index_ < index) step(index_ + 1);
  combine();
  return gust_;
}

void Dryden::visit(state::Visitor& v) {
  v("period", index_);
  v("along", along_);
  v("across", across_);
  v("gust", numbers(gust_));
}

}  // namespace mebots::world
