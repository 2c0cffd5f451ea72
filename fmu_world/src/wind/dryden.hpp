// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/eigen_state.hpp"
#include "math/periods.hpp"
#include "mebots/state/visitor.hpp"

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace mebots::world {

/// Computes gusts by the Dryden model (MIL-STD-1797A): frozen turbulence that the wind carries past the drone with
/// `speed`. All axes have the same length scale L.
///
///   along x:   H(s) = sigma sqrt(2 L / (pi V)) / (1 + L/V s)
///   y and z:   H(s) = sigma sqrt(L / (pi V)) (1 + sqrt(3) L/V s) / (1 + L/V s)^2
///
/// Each has the standard deviation sigma. The filters advance every 10 ms, with the exact discrete solution for white
/// noise. Between two such times, the gust is constant. The noise depends only on seed and time, and not on the step or
/// on other instances. The filters start in their stationary distribution.
class Dryden {
 public:
  struct Settings {
    double intensity_m_per_s = 0.0;  ///< sigma, >= 0; 0 = no gusts
    double length_m = 5.0;           ///< L, > 0
    double speed_m_per_s = 1.0;      ///< V, > 0
    std::uint64_t seed = 1;
  };

  /// Throws mebots::Error if a value is out of range.
  explicit Dryden(const Settings& settings);

  /// Advances to a time, which must not be before the time of the previous call. Returns the gust at this time [m/s],
  /// in world axes.
  const Eigen::Vector3d& at(std::int64_t time_ns);

  void visit(state::Visitor& v);

 private:
  void begin(std::int64_t index);
  void step(std::int64_t index);
  void combine();
  double normal(std::int64_t index, std::size_t which) const;

  Settings settings_;
  double decay_;                    // exp(-dt V / L)
  double share_;                    // dt V / L
  double spread_x_;                 // spread of the noise on the first filter's state
  std::array<double, 3> root_;      // lower Cholesky factor of the noise on the two states of y and of z
  std::int64_t index_ = kNoPeriod;  // number of the last filter step
  double along_ = 0.0;              // state of the filter along x
  std::array<double, 4> across_{};  // states of the filters along y, then along z
  Eigen::Vector3d gust_ = Eigen::Vector3d::Zero();
};

}  // namespace mebots::world
