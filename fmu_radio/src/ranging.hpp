// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "channel.hpp"

namespace mebots::radio {

/// Measures distances by ultra-wideband, in double-sided two-way ranging with four messages: request, answer, final and
/// report. Exchanges share one channel, one after the other. If a node requests a second distance during its exchange,
/// the second request fails.
class Ranging {
 public:
  Ranging(const Parameters& parameters, std::span<NodeVariables> nodes);

  /// Measures distances during the step, and sets the outputs of all nodes. Throws mebots::Error if a node requests its
  /// distance to itself or to an unknown node.
  void step(const Span& span);

  /// Returns the energy that a node's ranging radio consumes in the step [J]. Both nodes of an exchange send two
  /// messages, and receive for the rest of the time.
  double energy_j(std::size_t node, const Span& span) const;

  void visit(state::Visitor& v);

 private:
  struct Exchange {
    std::int64_t begin_ns = 0;
    std::int64_t end_ns = 0;
    std::int32_t from = 0;  // number of the requesting node, from 1
    std::int32_t to = 0;
    std::int64_t number = 0;

    void visit(state::Visitor& v);
  };

  void take_request(std::size_t node, std::int64_t time_ns);
  void finish(const Exchange& exchange);

  const Parameters& parameters_;
  std::span<NodeVariables> variables_;
  std::vector<std::int32_t> counts_;    // value of ranging.count of each node in the last step
  std::vector<std::int64_t> requests_;  // number of requests of each node so far
  std::vector<Exchange> exchanges_;     // waiting and active exchanges, ordered by their begin
  std::vector<Exchange> ended_;         // exchanges that ended in the last step, for the energy of that step
  std::int64_t free_ns_ = 0;
};

}  // namespace mebots::radio
