// SPDX-License-Identifier: Apache-2.0
// The section `algorithm`.
#include "mebots/input_error.hpp"
#include "reading.hpp"
#include "sections.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>

namespace mebots::master::config {
namespace {

std::vector<std::string> read_order(const Node& node, const SystemDescription& system) {
  std::vector<std::string> order;
  std::set<std::string> named;
  for (const auto& element : node.elements()) {
    element.attempt([&] {
      auto name = instance_name(element.text(), element, system);
      if (!named.insert(name).second) {
        element.fail(ErrorCode::duplicate_name, fmt::format("the instance '{}' is there twice", name));
      }
      order.push_back(std::move(name));
    });
  }
  std::vector<std::string> missing;
  for (const auto& name : system.instance_names()) {
    if (!named.contains(name)) missing.push_back(name);
  }
  if (!missing.empty()) {
    node.complain(ErrorCode::invalid_value,
                  fmt::format("the order must name every instance; missing: {}", fmt::join(missing, ", ")));
  }
  return order;
}

}  // namespace

void read_algorithm(const Node& node, SystemDescription& system) {
  auto& algorithm = system.algorithm;
  if (node.is(data::Kind::text)) {
    algorithm.type = node.text();
  } else {
    Object object(node);
    object.read("type", algorithm.type, &Node::text);
    object.read_if("order", algorithm.order, [&](const Node& order) { return read_order(order, system); });
    object.finish();
  }
  try {
    find_algorithm(algorithm);
  } catch (const InputError& error) {
    node.complain(error.code(), error.what());
  }
}

}  // namespace mebots::master::config
