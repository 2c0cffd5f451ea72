// SPDX-License-Identifier: Apache-2.0
#include "model.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <cmath>

namespace mebots::radio {
namespace {

std::span<NodeVariables> present(const Parameters& parameters, std::span<NodeVariables> nodes) {
  const auto count = parameters.node_count;
  if (count >= 1 && static_cast<std::size_t>(count) <= nodes.size())
    return nodes.first(static_cast<std::size_t>(count));
  throw Error(fmt::format("node.count = {} must be 1 to {}: this FMU has no more nodes", count, nodes.size()));
}

void check(std::span<const NodeVariables> nodes) {
  constexpr double kMost_m = 1e9;
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double value = nodes[i].inputs.position_m[axis];
      if (std::abs(value) <= kMost_m) continue;
      throw Error(fmt::format("node[{}].position.{} = {} m must be within {} m", i + 1, kAxes[axis], value, kMost_m));
    }
  }
}

}  // namespace

Model::Model(const Parameters& parameters, std::span<NodeVariables> nodes, std::int64_t start_ns, const Log& log)
    : nodes_(present(parameters, nodes)),
      channel_(
          parameters, nodes_, log ? log : [](std::string_view) {}),
      ranging_(parameters, nodes_),
      positioning_(parameters, nodes_, start_ns) {
  for (auto& node : nodes_) {
    node.outputs.power_w = parameters.packet_voltage_v * parameters.packet_listen_current_a +
                           parameters.ranging_voltage_v * parameters.ranging_idle_current_a;
  }
}

void Model::step(std::int64_t start_ns, std::int64_t duration_ns) {
  check(nodes_);
  const Span span{start_ns, start_ns + duration_ns};
  channel_.step(span);
  ranging_.step(span);
  positioning_.step(span);
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const double energy_j = channel_.energy_j(i, span) + ranging_.energy_j(i, span);
    nodes_[i].outputs.power_w = energy_j / (static_cast<double>(duration_ns) * 1e-9);
    nodes_[i].outputs.energy_j += energy_j;
  }
}

void Model::visit(state::Visitor& v) {
  v("channel", channel_);
  v("ranging", ranging_);
  v("positioning", positioning_);
}

}  // namespace mebots::radio
