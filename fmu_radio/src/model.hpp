// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "channel.hpp"
#include "positioning.hpp"
#include "ranging.hpp"

namespace mebots::radio {

/// Models the packets, distances and positions of all nodes. Inputs are constant during a step. A request at the
/// beginning of a step is processed at that time, or when the channel is free. Its result is in the outputs after the
/// step in which it completes.
class Model {
 public:
  /// The variables must outlive the model. Throws mebots::Error if there are no nodes, or no variables for a node.
  Model(const Parameters& parameters, std::span<NodeVariables> nodes, std::int64_t start_ns, const Log& log = {});

  void step(std::int64_t start_ns, std::int64_t duration_ns);
  void visit(state::Visitor& v);

 private:
  std::span<NodeVariables> nodes_;
  Channel channel_;
  Ranging ranging_;
  Positioning positioning_;
};

}  // namespace mebots::radio
