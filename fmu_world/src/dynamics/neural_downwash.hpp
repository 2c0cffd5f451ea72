// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/rigid_world.hpp"
#include "scene/downwash_networks.hpp"

#include <span>
#include <vector>

namespace mebots::world {

/// Predicts with networks the vertical force of other drones' air on a drone. For each drone, call begin(), then add()
/// for each other drone, then force_W_n().
///
/// All sums have a fixed order. Therefore equal states that are added in the same order give the same bits. Only the
/// constructor allocates memory.
class NeuralDownwash {
 public:
  explicit NeuralDownwash(scene::DownwashNetworks networks);

  void begin(const RigidState& self);
  /// Adds another drone. Ignores it if it is not inside the limits of the networks.
  void add(const RigidState& other);
  /// Returns the force [N] along the world's z axis. If DownwashNetworks::include_alone is false, subtracts the
  /// prediction for the drone without neighbours. Then a drone without neighbours has the force 0.
  double force_W_n();

 private:
  /// Sets `alone_` and `features_` to the features of the drone without neighbours.
  void find_alone();
  /// Returns the outputs of a network. They are valid until the next call.
  std::span<const double> outputs_of(const scene::Network& network, std::span<const double> inputs);
  double rho_of(std::span<const double> features);

  scene::DownwashNetworks networks_;
  RigidState self_;
  bool has_neighbours_ = false;
  std::vector<double> alone_;     // features of a drone without neighbours
  std::vector<double> features_;  // sum of `alone_` and the features of all neighbours
  std::vector<double> values_;    // inputs and outputs of a layer
  std::vector<double> next_;
};

}  // namespace mebots::world
