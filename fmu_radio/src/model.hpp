// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "channel.hpp"
#include "positioning.hpp"
#include "ranging.hpp"

namespace mebots::radio {

/// Packets, distances and positions of all nodes. Plain C++; fmu.cpp binds it to FMI.
///
/// Inputs are constant during a step. A request that the inputs show at the begin of a step is met then, or when the
/// channel is free. Its effect is in the outputs of the step in which it is complete.
class Model {
 public:
  /// The variables must outlive the model. Throws mebots::Error if there are more nodes than variables.
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
