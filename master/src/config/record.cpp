// SPDX-License-Identifier: Apache-2.0
// The section `record`.
#include "mebots/master/time.hpp"

#include "reading.hpp"
#include "sections.hpp"

#include <fmt/format.h>

namespace mebots::master::config {

void read_record(const JsonNode& node, SystemDescription& system) {
  auto& record = system.record;
  std::optional<JsonNode> patterns;
  if (node.value().is_array()) {
    patterns = node;
  } else {
    node.expect_keys({"variables", "interval"});
    patterns = node.find("variables");
    if (const auto interval = node.find("interval")) {
      record.interval_ns = interval->nanoseconds();
      if (record.interval_ns <= 0 || record.interval_ns % system.step_ns != 0) {
        interval->fail(
            fmt::format("the recording interval is not a multiple of the step {} s", to_seconds(system.step_ns)));
      }
    }
  }
  if (patterns) {
    record.patterns.emplace();
    for (const auto& element : patterns->elements())
      record.patterns->push_back({readable_text(element), element.place()});
  }
}

}  // namespace mebots::master::config
