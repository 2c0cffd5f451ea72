// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/airframe.hpp"

#include <Eigen/Core>

namespace mebots::world {

/// Rotor thrusts that give a collective thrust and a torque about the body's axes.
///
/// Inverse of rotor_wrench() with torque = torque_per_thrust * thrust. When a rotor would leave
/// 0..max_thrust_n, what matters least gives way first: the yaw torque is lowered, then the collective is moved,
/// then roll and pitch are scaled. Roll and pitch keep the drone in the air; yaw and height can wait.
RotorValues mix(const scene::Drone& drone, double max_thrust_n, double collective_n,
                const Eigen::Vector3d& torque_B_n_m);

}  // namespace mebots::world
