// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/eigen_state.hpp"
#include "mebots/state/visitor.hpp"

#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace mebots::world::crazyflie {

/// A second-order Butterworth low-pass for three axes (bilinear transform, direct form II). Starts in the steady state
/// of its first sample.
class LowPass {
 public:
  LowPass(double cutoff_hz, double rate_hz) {
    const double w = std::tan(std::numbers::pi * cutoff_hz / rate_hz);
    const double scale = 1.0 / (1.0 + std::numbers::sqrt2 * w + w * w);
    b_ = w * w * scale;
    a1_ = 2.0 * (w * w - 1.0) * scale;
    a2_ = (1.0 - std::numbers::sqrt2 * w + w * w) * scale;
  }

  Eigen::Vector3d operator()(const Eigen::Vector3d& sample) {
    if (!begun_) {
      begun_ = true;
      before_ = before_that_ = sample / (1.0 + a1_ + a2_);
    }
    const Eigen::Vector3d inside = sample - a1_ * before_ - a2_ * before_that_;
    const Eigen::Vector3d filtered = b_ * (inside + 2.0 * before_ + before_that_);
    before_that_ = before_;
    before_ = inside;
    return filtered;
  }

  void visit(state::Visitor& v) {
    v("begun", begun_);
    v("before", numbers(before_));
    v("before_that", numbers(before_that_));
  }

 private:
  double b_;
  double a1_;
  double a2_;
  bool begun_ = false;
  Eigen::Vector3d before_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d before_that_ = Eigen::Vector3d::Zero();
};

}  // namespace mebots::world::crazyflie
