// SPDX-License-Identifier: Apache-2.0
// The section `algorithm`.
#include "base/nearest_names.hpp"

#include "reading.hpp"
#include "sections.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace mebots::master::config {
namespace {

AlgorithmDescription::Kind read_kind(const JsonNode& node) {
  const auto text = node.string();
  if (text == "jacobi") return AlgorithmDescription::Kind::jacobi;
  if (text == "gauss-seidel") return AlgorithmDescription::Kind::gauss_seidel;
  static const std::vector<std::string> kKinds = {"jacobi", "gauss-seidel"};
  node.fail(fmt::format("there is no algorithm '{}'. {}", text, suggest(text, kKinds)));
}

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
  if (node.value().is_string()) {
    algorithm.kind = read_kind(node);
    return;
  }
  node.expect_keys({"type", "order"});
  algorithm.kind = read_kind(node.at("type"));
  const auto order = node.find("order");
  if (!order) return;
  if (algorithm.kind == AlgorithmDescription::Kind::jacobi) {
    order->fail("Jacobi steps all instances on the same values, so it takes no order");
  }
  algorithm.order = read_order(*order, system);
}

}  // namespace mebots::master::config
