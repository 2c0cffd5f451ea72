// SPDX-License-Identifier: Apache-2.0
// The section `connections`.
#include "reading.hpp"
#include "sections.hpp"

namespace mebots::master::config {

void read_connections(const JsonNode& node, SystemDescription& system) {
  for (const auto& element : node.elements()) {
    element.expect_keys({"from", "to", "factor", "offset", "convert_units", "text"});
    ConnectionDescription connection;
    connection.from = variable_name(element.at("from"), system);
    connection.to = variable_name(element.at("to"), system);
    connection.place = element.place();
    if (const auto factor = element.find("factor")) {
      connection.factor = factor->number();
      if (connection.factor == 0) factor->fail("a factor of 0 would cut the connection; leave it out instead");
    }
    if (const auto offset = element.find("offset")) connection.offset = offset->number();
    if (const auto convert = element.find("convert_units")) connection.convert_units = convert->boolean();
    if (const auto text = element.find("text")) text->string();  // for people only
    system.connections.push_back(std::move(connection));
  }
}

}  // namespace mebots::master::config
