// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "channel.hpp"

namespace mebots::radio {

/// Measures the positions of the nodes, as motion capture or base stations do. Sample n of all nodes is taken at the
/// first communication point at or after n / rate since the start.
class Positioning {
 public:
  Positioning(const Parameters& parameters, std::span<NodeVariables> nodes, std::int64_t start_ns);

  void step(const Span& span);
  void visit(state::Visitor& v);

 private:
  struct Fix {
    std::int64_t there_ns = 0;
    std::uint64_t node = 0;
    std::array<double, 3> position_m{};

    void visit(state::Visitor& v);
  };

  void sample(std::int64_t time_ns);

  const Parameters& parameters_;
  std::span<NodeVariables> variables_;
  std::int64_t start_ns_;
  std::int64_t next_ = 0;       // number of the next sample
  std::vector<Fix> under_way_;  // samples that are not in the outputs yet, ordered by time
};

}  // namespace mebots::radio
