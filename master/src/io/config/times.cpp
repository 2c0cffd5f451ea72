// SPDX-License-Identifier: Apache-2.0
// The sections `text`, `step`, `start_time` and `stop_time`.
#include "reading.hpp"
#include "sections.hpp"

#include <fmt/format.h>

namespace mebots::master::config {

void read_text(const Node& node, SystemDescription& /*system*/) {
  static_cast<void>(node.text());  // for people only
}

void read_step(const Node& node, SystemDescription& system) {
  const auto step = step_time(node);
  if (node.kind() != data::Kind::text && !step.is_whole_nanoseconds()) {
    system.notices.push_back(fmt::format("{}: the step {} s means {} s", node.place(), node.shown(), time_text(step)));
  }
  system.step = step;
}

void read_start_time(const Node& node, SystemDescription& system) {
  const auto start_time = written_time(node);
  if (!start_time.is_whole_nanoseconds()) {
    node.fail(ErrorCode::invalid_value,
              fmt::format("the start time {} s must be a whole number of nanoseconds", node.shown()));
  }
  system.start_time_ns = to_nanoseconds(start_time);
}

void read_stop_time(const Node& node, SystemDescription& system) {
  const auto stop_time_ns = to_nanoseconds(written_time(node));
  if (const auto problem = stop_time_problem(system, stop_time_ns)) node.fail(ErrorCode::invalid_value, *problem);
  system.stop_time_ns = stop_time_ns;
}

}  // namespace mebots::master::config
