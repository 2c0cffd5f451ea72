// SPDX-License-Identifier: Apache-2.0
#include "scene/downwash_networks.hpp"

#include "mebots/data/document.hpp"
#include "mebots/data/object.hpp"

#include <fmt/format.h>
#include <array>
#include <string_view>
#include <utility>

namespace mebots::world::scene {
namespace {

using data::Limits;
using data::Node;
using data::Object;
using data::quantity;

constexpr std::size_t kMostLayers = 16;
constexpr std::size_t kMostOutputs = 512;
constexpr std::size_t kNeighbourInputs = 6;
constexpr std::size_t kGroundInputs = 4;
const Limits kWeights = Limits::between(-1e6, 1e6);

NetworkLayer read_layer(const Node& node) {
  Object object(node);
  std::vector<std::vector<double>> rows;
  NetworkLayer layer;
  object.read("weights", rows, data::list_of(data::numbers(kWeights)));
  object.read("offsets", layer.offsets, data::numbers(kWeights));
  object.finish();
  if (!object.sound()) return layer;
  if (rows.empty() || rows.size() > kMostOutputs) {
    node.at("weights").fail(ErrorCode::invalid_value,
                            fmt::format("a layer needs 1 to {} rows, one for each output", kMostOutputs));
  }
  layer.outputs = rows.size();
  layer.inputs = rows.front().size();
  const auto row_nodes = node.at("weights").elements();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].size() == layer.inputs) continue;
    row_nodes[i].fail(ErrorCode::invalid_value,
                      fmt::format("this row has {} numbers, but the first row has {}", rows[i].size(), layer.inputs));
  }
  if (layer.offsets.size() != layer.outputs) {
    node.at("offsets").fail(ErrorCode::invalid_value, fmt::format("there are {} numbers here, but {} rows in weights",
                                                                  layer.offsets.size(), layer.outputs));
  }
  layer.weights.reserve(layer.inputs * layer.outputs);
  for (std::size_t column = 0; column < layer.inputs; ++column) {
    for (const auto& row : rows) layer.weights.push_back(row[column]);
  }
  return layer;
}

/// Reads the layers of a network. Fails if a layer does not have as many inputs as the layer before it has outputs.
Network read_network(const Node& node) {
  const auto noted = node.noted();
  Network network = data::list_of(&read_layer)(node);
  if (node.noted() != noted) return network;
  if (network.empty() || network.size() > kMostLayers) {
    node.fail(ErrorCode::invalid_value, fmt::format("a network needs 1 to {} layers", kMostLayers));
  }
  const auto layers = node.elements();
  for (std::size_t i = 1; i < network.size(); ++i) {
    if (network[i].inputs == network[i - 1].outputs) continue;
    layers[i].at("weights").fail(ErrorCode::invalid_value,
                                 fmt::format("this layer has {} inputs, but the layer before it has {} outputs",
                                             network[i].inputs, network[i - 1].outputs));
  }
  return network;
}

void check_inputs(const Node& node, const Network& network, std::size_t inputs, std::string_view meaning) {
  if (network.front().inputs == inputs) return;
  node.complain(ErrorCode::invalid_value, fmt::format("the first layer has {} inputs, but needs {}: {}",
                                                      network.front().inputs, inputs, meaning));
}

void check_shapes(const Node& node, const DownwashNetworks& networks) {
  const std::size_t features = networks.rho.front().inputs;
  const auto check_outputs = [&](std::string_view key, const Network& network) {
    if (network.back().outputs == features) return;
    node.at(key).complain(ErrorCode::invalid_value,
                          fmt::format("the last layer has {} outputs, but the first layer of rho has {} inputs",
                                      network.back().outputs, features));
  };
  check_inputs(node.at("phi"), networks.phi, kNeighbourInputs,
               "x, y, z, velocity x, y, z of a neighbour relative to the drone");
  check_outputs("phi", networks.phi);
  if (!networks.phi_ground.empty()) {
    check_inputs(node.at("phi_ground"), networks.phi_ground, kGroundInputs,
                 "minus the drone's height, minus its velocity x, y, z");
    check_outputs("phi_ground", networks.phi_ground);
  }
  if (networks.rho.back().outputs != 1) {
    node.at("rho").complain(
        ErrorCode::invalid_value,
        fmt::format("the last layer has {} outputs, but needs 1: the force", networks.rho.back().outputs));
  }
}

void read_limits(const Node& node, DownwashNetworks& networks) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, kNeighbourInputs> kComponents{
      {{"x", "m"}, {"y", "m"}, {"z", "m"}, {"velocity_x", "m/s"}, {"velocity_y", "m/s"}, {"velocity_z", "m/s"}}};
  const auto positive = Limits::positive();
  Object object(node);
  for (std::size_t i = 0; i < kComponents.size(); ++i) {
    object.read_if(kComponents[i].first, networks.neighbour_limits[i], quantity(kComponents[i].second, positive));
  }
  object.read_if("height", networks.height_limit_m, quantity("m", positive));
  object.finish();
}

DownwashNetworks read_downwash_networks(const Node& node) {
  Object object(node);
  DownwashNetworks networks;
  object.comment("$schema");
  object.read("name", networks.name, &Node::text);
  data::read_source(object);
  object.read("force_per_output", networks.force_per_output_n, quantity("N"));
  object.read_if("include_alone", networks.include_alone, &Node::flag);
  object.visit_if("limits", [&](const Node& limits) { read_limits(limits, networks); });
  object.read("phi", networks.phi, &read_network);
  object.read_if("phi_ground", networks.phi_ground, &read_network);
  object.read("rho", networks.rho, &read_network);
  object.finish();
  if (object.sound()) check_shapes(node, networks);
  return networks;
}

}  // namespace

DownwashNetworks load_downwash_networks(const std::filesystem::path& file) {
  return data::Document(file).read(&read_downwash_networks);
}

}  // namespace mebots::world::scene
