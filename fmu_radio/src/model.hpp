// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "channel.hpp"
#include "positioning.hpp"
#include "ranging.hpp"

namespace mebots::radio {

/// Models the packets, distances and positions of all nodes in plain C++; fmu.cpp binds the class to FMI.
/// Inputs are constant during a step. A request in the inputs at the beginning of a step is processed at that time, or
/// when the channel is free. The outputs contain the result of a request after the step in which it completes.
class Model {
 public:
  /// The variables must outlive the model. Throws mebots::Error if there is no node, or no variables for a node.
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
