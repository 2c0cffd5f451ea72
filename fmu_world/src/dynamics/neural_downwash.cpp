// SPDX-License-Identifier: Apache-2.0
#include "dynamics/neural_downwash.hpp"

#include "mebots/assert.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace mebots::world {
namespace {

/// Returns the largest number of inputs or outputs of any layer.
std::size_t width_of(const scene::DownwashNetworks& networks) {
  std::size_t width = 0;
  for (const auto* network : {&networks.phi, &networks.phi_ground, &networks.rho}) {
    for (const auto& layer : *network) width = std::max({width, layer.inputs, layer.outputs});
  }
  return width;
}

}  // namespace

NeuralDownwash::NeuralDownwash(scene::DownwashNetworks networks)
    : networks_(std::move(networks)),
      alone_(networks_.rho.front().inputs),
      features_(alone_.size()),
      values_(width_of(networks_)),
      next_(values_.size()) {}

void NeuralDownwash::begin(const RigidState& self) {
  self_ = self;
  has_neighbours_ = false;
}

void NeuralDownwash::find_alone() {
  std::fill(alone_.begin(), alone_.end(), 0.0);
  if (!networks_.phi_ground.empty()) {
    const Eigen::Vector3d& v = self_.v_WB_m_per_s;
    const std::array inputs{-std::min(self_.p_WB_m.z(), networks_.height_limit_m), -v.x(), -v.y(), -v.z()};
    const auto outputs = outputs_of(networks_.phi_ground, inputs);
    std::copy(outputs.begin(), outputs.end(), alone_.begin());
  }
  features_ = alone_;
}

void NeuralDownwash::add(const RigidState& other) {
  const Eigen::Vector3d p = other.p_WB_m - self_.p_WB_m;
  const Eigen::Vector3d v = other.v_WB_m_per_s - self_.v_WB_m_per_s;
  const std::array inputs{p.x(), p.y(), p.z(), v.x(), v.y(), v.z()};
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (!(std::abs(inputs[i]) < networks_.neighbour_limits[i])) return;
  }
  if (!has_neighbours_) find_alone();
  has_neighbours_ = true;
  const auto outputs = outputs_of(networks_.phi, inputs);
  for (std::size_t i = 0; i < features_.size(); ++i) features_[i] += outputs[i];
}

double NeuralDownwash::force_W_n() {
  if (!has_neighbours_ && !networks_.include_alone) return 0.0;
  if (!has_neighbours_) find_alone();
  if (networks_.include_alone) return networks_.force_per_output_n * rho_of(features_);
  const double with_neighbours = rho_of(features_);
  return networks_.force_per_output_n * (with_neighbours - rho_of(alone_));
}

double NeuralDownwash::rho_of(std::span<const double> features) {
  return outputs_of(networks_.rho, features)[0];
}

/// In each layer, adds the columns of the matrix one after the other. Therefore the order of the additions does not
/// depend on how the compiler vectorizes the inner loop.
std::span<const double> NeuralDownwash::outputs_of(const scene::Network& network, std::span<const double> inputs) {
  MEBOTS_ASSERT(inputs.size() == network.front().inputs);
  std::copy(inputs.begin(), inputs.end(), values_.begin());
  for (std::size_t k = 0; k < network.size(); ++k) {
    const scene::NetworkLayer& layer = network[k];
    std::copy(layer.offsets.begin(), layer.offsets.end(), next_.begin());
    const double* column = layer.weights.data();
    for (std::size_t j = 0; j < layer.inputs; ++j, column += layer.outputs) {
      const double value = k == 0 ? values_[j] : std::max(values_[j], 0.0);
      for (std::size_t i = 0; i < layer.outputs; ++i) next_[i] += column[i] * value;
    }
    std::swap(values_, next_);
  }
  return {values_.data(), network.back().outputs};
}

}  // namespace mebots::world
