// SPDX-License-Identifier: Apache-2.0
// The sections `text`, `step`, `start_time` and `stop_time`.
#include "reading.hpp"
#include "sections.hpp"

namespace mebots::master::config {

void read_text(const Node& node, SystemDescription& /*system*/) {
  static_cast<void>(node.text());  // for people only
}

void read_step(const Node& node, SystemDescription& system) {
  const auto step_ns = time_ns(node);
  if (step_ns <= 0) node.fail(ErrorCode::value_out_of_range, "the step must be greater than 0 s");
  system.step_ns = step_ns;
}

void read_start_time(const Node& node, SystemDescription& system) {
  const auto start_time_ns = time_ns(node);
  if (start_time_ns < 0) node.fail(ErrorCode::value_out_of_range, "the start time must not be negative");
  system.start_time_ns = start_time_ns;
}

void read_stop_time(const Node& node, SystemDescription& system) {
  const auto stop_time_ns = time_ns(node);
  if (const auto problem = stop_time_problem(system, stop_time_ns)) node.fail(ErrorCode::invalid_value, *problem);
  system.stop_time_ns = stop_time_ns;
}

}  // namespace mebots::master::config
