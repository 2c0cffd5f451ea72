// SPDX-License-Identifier: Apache-2.0
#include "dynamics/airframe.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>

namespace mebots::world {

Eigen::Vector3d inertia_for(const scene::Drone& drone, double mass_kg) {
  if (!(mass_kg > 0.0)) {
    throw Error(fmt::format("drone.dry_mass + cell.mass = {} kg: the drone needs a mass greater than 0", mass_kg));
  }
  const Eigen::Vector3d squares = drone.load_size_m.cwiseAbs2();
  // Even box: J_x = m (b^2 + c^2) / 12 and so on.
  const Eigen::Vector3d per_mass_m2 = (Eigen::Vector3d::Constant(squares.sum()) - squares) / 12.0;
  Eigen::Vector3d inertia = drone.inertia_kg_m2 + (mass_kg - drone.reference_mass_kg) * per_mass_m2;
  if (!(inertia.minCoeff() > 0.0)) {
    throw Error(
        fmt::format("drone.dry_mass + cell.mass = {} kg: drone \"{}\" has no positive inertia left at this mass; "
                    "its inertia holds for {} kg",
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
    // r x (0, 0, f): the rotor's height does not matter for a thrust along z.
    wrench.torque_n_m += Eigen::Vector3d{y_m * thrust_n[i], -x_m * thrust_n[i], kRotorYawSign[i] * torque_n_m[i]};
  }
  return wrench;
}

Eigen::Vector3d drag_force(const scene::Drone& drone, const RigidState& state, const Eigen::Vector3d& wind_W_m_per_s) {
  const Eigen::Vector3d airspeed_B = state.q_WB.conjugate() * (state.v_WB_m_per_s - wind_W_m_per_s);
  return state.q_WB * (-drone.drag_n_s_per_m.cwiseProduct(airspeed_B));
}

}  // namespace mebots::world
