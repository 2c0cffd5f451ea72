// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dynamics/rigid_world.hpp"
#include "scene/downwash_networks.hpp"

#include <span>
#include <vector>

namespace mebots::world {

/// Computes the vertical force of other drones' air on a drone with networks. For each drone, call begin(), then add()
/// for each other drone, then force_W_n().
///
/// Sums run in a fixed order, so the force has the same bits for the same states in the same order. No function
/// allocates memory.
class NeuralDownwash {
 public:
  explicit NeuralDownwash(scene::DownwashNetworks networks);

  void begin(const RigidState& self);
  /// Adds a drone, if it is inside the limits of the networks.
  void add(const RigidState& other);
  /// Returns the force [N] along the world's z axis. If begin() was called without add() of a neighbour, returns the
  /// networks' prediction for a drone alone, or 0 if the networks exclude it.
  double force_W_n();

 private:
  /// Returns the outputs of a network. They are valid until the next call.
  std::span<const double> outputs_of(const scene::Network& network, std::span<const double> inputs);
  double rho_of(std::span<const double> features);

  scene::DownwashNetworks networks_;
  RigidState self_;
  bool has_neighbours_ = false;
  std::vector<double> alone_;     // features of a drone without neighbours
  std::vector<double> features_;  // those and the features of the neighbours
  std::vector<double> values_;    // inputs and outputs of a layer
  std::vector<double> next_;
};

}  // namespace mebots::world
