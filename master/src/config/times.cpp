// SPDX-License-Identifier: Apache-2.0
// The sections `text`, `step` and `stop_time`.
#include "sections.hpp"

namespace mebots::master::config {

void read_text(const JsonNode& node, SystemDescription& /*system*/) {
  node.string();  // for people only
}

void read_step(const JsonNode& node, SystemDescription& system) {
  system.step_ns = node.nanoseconds();
  if (system.step_ns <= 0) node.fail("the step must be greater than 0 s");
}

void read_stop_time(const JsonNode& node, SystemDescription& system) {
  set_stop_time(system, node.nanoseconds(), node.place());
}

}  // namespace mebots::master::config
