// SPDX-License-Identifier: Apache-2.0
// The section `record`.
#include "base/time.hpp"

#include "reading.hpp"
#include "sections.hpp"

#include <fmt/format.h>

namespace mebots::master::config {
namespace {

std::vector<RecordPattern> read_patterns(const JsonNode& node) {
  std::vector<RecordPattern> patterns;
  for (const auto& element : node.elements()) patterns.push_back({readable_text(element), element.place()});
  return patterns;
}

/// `true` for all, or patterns.
std::vector<RecordPattern> read_parameters(const JsonNode& node) {
  if (!node.value().is_boolean()) return read_patterns(node);
  return node.boolean() ? std::vector<RecordPattern>{{"*", node.place()}} : std::vector<RecordPattern>{};
}

void read_format(const JsonNode& node, RecordDescription& record) {
  const auto format = node.string();
  if (format != "csv" && format != "hdf5" && format != "both") {
    node.fail(fmt::format("'{}' is none of 'csv', 'hdf5' and 'both'", format));
  }
  record.csv = format != "hdf5";
  record.hdf5 = format != "csv";
}

}  // namespace

void read_record(const JsonNode& node, SystemDescription& system) {
  auto& record = system.record;
  if (node.value().is_array()) {
    record.patterns = read_patterns(node);
    return;
  }
  node.expect_keys({"variables", "exclude", "interval", "parameters", "texts", "format"});
  if (const auto patterns = node.find("variables")) record.patterns = read_patterns(*patterns);
  if (const auto patterns = node.find("exclude")) record.exclude = read_patterns(*patterns);
  if (const auto parameters = node.find("parameters")) record.parameters = read_parameters(*parameters);
  if (const auto format = node.find("format")) read_format(*format, record);
  if (const auto texts = node.find("texts")) record.texts = texts->boolean();
  if (const auto interval = node.find("interval")) {
    record.interval_ns = interval->nanoseconds();
    if (record.interval_ns <= 0 || record.interval_ns % system.step_ns != 0) {
      interval->fail(
          fmt::format("the recording interval is not a multiple of the step {} s", to_seconds(system.step_ns)));
    }
  }
}

}  // namespace mebots::master::config
