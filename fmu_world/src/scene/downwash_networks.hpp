// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace mebots::world::scene {

/// A linear layer: y = W x + b.
struct NetworkLayer {
  std::size_t inputs = 0;
  std::size_t outputs = 0;
  std::vector<double> weights;  ///< W, column by column
  std::vector<double> offsets;  ///< b
};

/// Linear layers with ReLU between them.
using Network = std::vector<NetworkLayer>;

/// Networks that predict the vertical force of other drones' air on a drone (Neural-Swarm2: Shi et al., IEEE
/// Transactions on Robotics 38, 2022). With the sum over the neighbours j of drone i, the force along the world's z
/// axis is
///
///   f_i = force_per_output * rho(phi_ground(-z_i, -v_i) + sum phi(p_j - p_i, v_j - v_i))
///
/// Positions and velocities are in the world frame, in m and m/s. MEbots contains no trained networks.
struct DownwashNetworks {
  static constexpr double kNoLimit = std::numeric_limits<double>::infinity();

  std::string name;
  double force_per_output_n = 0.0;
  /// If false, the prediction for a drone without neighbours is subtracted from f_i, because it is no effect of other
  /// drones.
  bool include_alone = false;
  /// Relative position x, y, z [m] and relative velocity x, y, z [m/s]. A drone is a neighbour if the absolute value of
  /// each component is less than its limit.
  std::vector<double> neighbour_limits = std::vector<double>(6, kNoLimit);
  double height_limit_m = kNoLimit;  ///< at greater heights, phi_ground gets this height
  Network phi;                       ///< six inputs
  Network phi_ground;                ///< four inputs; if it has no layers, f_i lacks its term
  Network rho;                       ///< one output
};

/// Reads and checks a file of networks (docs/concepts/many-drones.md). Throws the same errors as load_scene().
DownwashNetworks load_downwash_networks(const std::filesystem::path& file);

}  // namespace mebots::world::scene
