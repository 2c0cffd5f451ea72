// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/eigen_state.hpp"

#include <Eigen/Geometry>

namespace mebots::world {

/// Where the drone's body B is in the world W, and how it moves. The body's origin is its centre of mass.
struct RigidState {
  Eigen::Vector3d p_WB_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_WB = Eigen::Quaterniond::Identity();
  Eigen::Vector3d v_WB_m_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d w_WB_W_rad_per_s = Eigen::Vector3d::Zero();  ///< angular velocity, in world axes

  /// R_WB: turns body axes into world axes.
  Eigen::Matrix3d rotation() const { return q_WB.toRotationMatrix(); }
  /// Angular velocity in body axes.
  Eigen::Vector3d body_rate_rad_per_s() const { return q_WB.conjugate() * w_WB_W_rad_per_s; }
  bool is_finite() const {
    return p_WB_m.allFinite() && q_WB.coeffs().allFinite() && v_WB_m_per_s.allFinite() && w_WB_W_rad_per_s.allFinite();
  }

  void visit(state::Visitor& v) {
    v("p_WB_m", numbers(p_WB_m));
    v("q_WB", numbers(q_WB));
    v("v_WB_m_per_s", numbers(v_WB_m_per_s));
    v("w_WB_W_rad_per_s", numbers(w_WB_W_rad_per_s));
  }
};

}  // namespace mebots::world
