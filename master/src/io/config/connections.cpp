// SPDX-License-Identifier: Apache-2.0
// The section `connections`.
#include "reading.hpp"
#include "sections.hpp"

namespace mebots::master::config {
namespace {

std::vector<MappedValue> read_map(const Node& node) {
  std::vector<MappedValue> map;
  for (const auto& [from, to] : node.members()) {
    to.attempt([&, &from = from, &to = to] { map.push_back({from, written_value(to), to.place()}); });
  }
  return map;
}

ConnectionDescription read_connection(const Node& node, const SystemDescription& system) {
  Object object(node);
  ConnectionDescription connection;
  connection.place = node.place();
  object.read("from", connection.from, variable_of(system));
  object.read("to", connection.to, variable_of(system));
  object.read_if("factor", connection.factor, [](const Node& member) {
    const auto factor = member.number();
    if (factor == 0) {
      member.fail(ErrorCode::invalid_value, "a factor of 0 would cut the connection; leave it out instead");
    }
    return factor;
  });
  object.read_if("offset", connection.offset, data::number());
  object.read_if("convert_units", connection.convert_units, &Node::flag);
  object.read_if("sum", connection.sum, &Node::flag);
  object.read_if("map", connection.map, read_map);
  object.comment("text");
  object.finish();
  return connection;
}

}  // namespace

void read_connections(const Node& node, SystemDescription& system) {
  system.connections = data::list_of([&](const Node& element) { return read_connection(element, system); })(node);
}

}  // namespace mebots::master::config
