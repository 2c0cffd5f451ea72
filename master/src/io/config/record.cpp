// SPDX-License-Identifier: Apache-2.0
// The section `record`.
#include "reading.hpp"
#include "sections.hpp"

namespace mebots::master::config {
namespace {

std::vector<RecordPattern> read_patterns(const Node& node) {
  return data::list_of([](const Node& element) {
    return RecordPattern{element.readable_text(), element.place()};
  })(node);
}

/// `true` for all, or patterns.
std::vector<RecordPattern> read_recorded_parameters(const Node& node) {
  if (!node.is(data::Kind::boolean)) return read_patterns(node);
  return node.flag() ? std::vector<RecordPattern>{{"*", node.place()}} : std::vector<RecordPattern>{};
}

struct Format {
  bool csv;
  bool hdf5;
};

}  // namespace

void read_record(const Node& node, SystemDescription& system) {
  static const auto format_of =
      data::word_of<Format>({{"csv", {true, false}}, {"hdf5", {false, true}}, {"both", {true, true}}});
  auto& record = system.record;
  if (node.is(data::Kind::list)) {
    record.patterns = read_patterns(node);
    return;
  }
  Object object(node);
  object.read_if("variables", record.patterns, &read_patterns);
  object.read_if("exclude", record.exclude, &read_patterns);
  object.read_if("parameters", record.parameters, &read_recorded_parameters);
  Format format{record.csv, record.hdf5};
  object.read_if("format", format, format_of);
  record.csv = format.csv;
  record.hdf5 = format.hdf5;
  object.read_if("texts", record.texts, &Node::flag);
  object.read_if("locals", record.locals, &Node::flag);
  object.read_if("interval", record.every_steps, [&](const Node& member) { return steps_in(member, system); });
  object.finish();
}

}  // namespace mebots::master::config
