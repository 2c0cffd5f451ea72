// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/eigen_state.hpp"
#include "scene/scene.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>

namespace mebots::world {

/// The pose and velocity of the drone's body B in the world W. The origin of the body's frame is the centre of mass.
struct RigidState {
  Eigen::Vector3d p_WB_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_WB = Eigen::Quaterniond::Identity();
  Eigen::Vector3d v_WB_m_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d w_WB_W_rad_per_s = Eigen::Vector3d::Zero();  ///< angular velocity, in world axes

  /// Returns R_WB, which converts vectors from body axes to world axes.
  Eigen::Matrix3d rotation() const { return q_WB.toRotationMatrix(); }
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

inline constexpr int kRotors = 4;
using RotorValues = std::array<double, kRotors>;

/// Rotor positions as multiples of the arm length, and the sign of each rotor's reaction torque on the body about z.
/// The order is front right, rear right, rear left, front left, as in docs/architecture.md. The first and the third
/// rotor turn counter-clockwise seen from above, so their reaction torque is clockwise.
inline constexpr std::array<double, kRotors> kRotorX{1.0, -1.0, -1.0, 1.0};
inline constexpr std::array<double, kRotors> kRotorY{-1.0, -1.0, 1.0, 1.0};
inline constexpr std::array<double, kRotors> kRotorYawSign{-1.0, 1.0, -1.0, 1.0};

/// A force at the centre of mass and a torque about it.
struct Wrench {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d torque_n_m = Eigen::Vector3d::Zero();
};

/// Returns the principal moments of inertia about body axes for a drone of `mass_kg`. They are the moments of the
/// measured drone plus the moments of the additional mass, which is spread evenly over a box of `drone.load_size_m` at
/// the centre. If the mass is less than the measured mass, the moments of the missing mass are subtracted. Throws
/// mebots::Error if the mass or a moment is not > 0.
Eigen::Vector3d inertia_for(const scene::Drone& drone, double mass_kg);

/// Returns the force and torque of the rotors on the body, in body axes: thrusts along +z at the rotors' positions, and
/// reaction torques.
Wrench rotor_wrench(const scene::Drone& drone, const RotorValues& thrust_n, const RotorValues& torque_n_m);

/// Returns the torque of the rotors' rotation on the body, in body axes. Their angular momentum h is along z, so the
/// torque is -dh/dt - w x h. `acceleration` is the rotors' angular acceleration, positive = faster.
Eigen::Vector3d spin_torque(double rotor_inertia_kg_m2, const RotorValues& speed_rad_per_s,
                            const RotorValues& acceleration_rad_per_s2, const Eigen::Vector3d& rate_B_rad_per_s);

/// Returns the factor by which the ground increases a rotor's thrust at the same speed (Cheeseman and Bennett 1955):
/// 1 / (1 - (R / 4z)^2) for a height z of the rotor's plane. Heights below R / 2 count as R / 2.
double ground_effect(double height_m, double rotor_radius_m);

/// Returns the linear drag of the body in moving air [N], in world axes: F = -R diag(d) R^T (v - wind).
Eigen::Vector3d drag_force(const scene::Drone& drone, const RigidState& state, const Eigen::Vector3d& wind_W_m_per_s);

}  // namespace mebots::world
