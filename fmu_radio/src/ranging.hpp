// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "channel.hpp"

namespace mebots::radio {

/// Distances by ultra-wideband: double-sided two-way ranging with four messages, request, answer, final and report. One
/// exchange at a time uses the channel; other exchanges wait. A node measures one distance at a time: a second request
/// during its exchange fails.
class Ranging {
 public:
  Ranging(const Parameters& parameters, std::span<NodeVariables> nodes);

  /// Measures distances, and sets the outputs of all nodes. Throws mebots::Error if a request is not for another node.
  void step(const Span& span);

  /// Returns the energy of a node's ranging radio in the step. Both nodes of an exchange send two messages and receive
  /// the rest of the time.
  double energy_j(std::size_t node, const Span& span) const;

  void visit(state::Visitor& v);

 private:
  struct Exchange {
    std::int64_t begin_ns = 0;
    std::int64_t end_ns = 0;
    std::int32_t from = 0;  // numbers count from 1
    std::int32_t to = 0;
    std::int64_t number = 0;

    void visit(state::Visitor& v);
  };

  void take_request(std::size_t node, std::int64_t time_ns);
  void finish(const Exchange& exchange);

  const Parameters& parameters_;
  std::span<NodeVariables> variables_;
  std::vector<std::int32_t> counts_;    // the last ranging.count of each node
  std::vector<std::int64_t> requests_;  // of each node so far
  std::vector<Exchange> exchanges_;     // waiting and under way, by their begin
  std::vector<Exchange> ended_;         // in the last step, for its energy
  std::int64_t free_ns_ = 0;
};

}  // namespace mebots::radio
