// SPDX-License-Identifier: Apache-2.0
#include "dynamics/airframe.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace mebots::world {

Eigen::Vector3d inertia_for(const scene::Drone& drone, double mass_kg) {
  if (!(mass_kg > 0.0)) {
    throw Error(fmt::format("drone.dry_mass + cell.mass = {} kg: the drone needs a mass greater than 0", mass_kg));
  }
  const Eigen::Vector3d squares = drone.load_size_m.cwiseAbs2();
  // A homogeneous box has J_x = m (b^2 + c^2) / 12 and so on.
  const Eigen::Vector3d per_mass_m2 = (Eigen::Vector3d::Constant(squares.sum()) - squares) / 12.0;
  Eigen::Vector3d inertia = drone.inertia_kg_m2 + (mass_kg - drone.reference_mass_kg) * per_mass_m2;
  if (!(inertia.minCoeff() > 0.0)) {
    throw Error(
        fmt::format("drone.dry_mass + cell.mass = {} kg: drone \"{}\" would have no positive inertia at this mass; "
                    "its inertia is that of {} kg",
                    mass_kg, drone.name, drone.reference_mass_kg));
  }
  return inertia;
}

Wrench rotor_wrench(const scene::Drone& drone, const RotorValues& thrust_n, const RotorValues& torque_n_m) {
  Wrench wrench;
  for (std::size_t i = 0; i < kRotors; ++i) {
    const double x_m = kRotorX[i] * drone.arm_m;
    const double y_m = kRotorY[i] * drone.arm_m;
    wrench.force_n.z() += thrust_n[i];
    // The torque is r x (0, 0, f), so the rotor's height has no effect.
    wrench.torque_n_m += Eigen::Vector3d{y_m * thrust_n[i], -x_m * thrust_n[i], kRotorYawSign[i] * torque_n_m[i]};
  }
  return wrench;
}

Eigen::Vector3d spin_torque(double rotor_inertia_kg_m2, const RotorValues& speed_rad_per_s,
                            const RotorValues& acceleration_rad_per_s2, const Eigen::Vector3d& rate_B_rad_per_s) {
  double momentum = 0.0;
  double growth = 0.0;
  for (std::size_t i = 0; i < kRotors; ++i) {
    // kRotorYawSign is the sign of the reaction torque, which is opposite to the rotor's rotation.
    momentum -= kRotorYawSign[i] * rotor_inertia_kg_m2 * speed_rad_per_s[i];
    growth -= kRotorYawSign[i] * rotor_inertia_kg_m2 * acceleration_rad_per_s2[i];
  }
  return {-rate_B_rad_per_s.y() * momentum, rate_B_rad_per_s.x() * momentum, -growth};
}

double ground_effect(double height_m, double rotor_radius_m) {
  const double ratio = rotor_radius_m / (4.0 * std::max(height_m, 0.5 * rotor_radius_m));
  return 1.0 / (1.0 - ratio * ratio);
}

Eigen::Vector3d drag_force(const scene::Drone& drone, const RigidState& state, const Eigen::Vector3d& wind_W_m_per_s) {
  const Eigen::Vector3d airspeed_B = state.q_WB.conjugate() * (state.v_WB_m_per_s - wind_W_m_per_s);
  return state.q_WB * (-drone.drag_n_s_per_m.cwiseProduct(airspeed_B));
}

}  // namespace mebots::world
