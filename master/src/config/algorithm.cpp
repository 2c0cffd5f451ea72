// SPDX-License-Identifier: Apache-2.0
// The section `algorithm`.
#include "reading.hpp"
#include "sections.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace mebots::master::config {
namespace {

std::vector<std::string> read_order(const JsonNode& node, const SystemDescription& system) {
  std::vector<std::string> order;
  for (const auto& element : node.elements()) {
    auto name = instance_name(element.string(), element, system);
    if (std::find(order.begin(), order.end(), name) != order.end()) {
      element.fail(fmt::format("the instance '{}' is there twice", name));
    }
    order.push_back(std::move(name));
  }
  std::vector<std::string> missing;
  for (const auto& name : system.instance_names()) {
    if (std::find(order.begin(), order.end(), name) == order.end()) missing.push_back(name);
  }
  if (!missing.empty()) {
    node.fail(fmt::format("the order must name every instance; missing: {}", fmt::join(missing, ", ")));
  }
  return order;
}

}  // namespace

void read_algorithm(const JsonNode& node, SystemDescription& system) {
  auto& algorithm = system.algorithm;
  algorithm.place = node.place();
  if (node.value().is_string()) {
    algorithm.type = node.string();
    return;
  }
  node.expect_keys({"type", "order"});
  algorithm.type = node.at("type").string();
  const auto order = node.find("order");
  if (!order) return;
  algorithm.order = read_order(*order, system);
}

}  // namespace mebots::master::config
