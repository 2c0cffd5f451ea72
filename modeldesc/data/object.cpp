// SPDX-License-Identifier: Apache-2.0
#include "mebots/data/object.hpp"

#include "mebots/data/estimate.hpp"

#include "mebots/nearest_names.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace mebots::data {
namespace {

constexpr std::size_t kUsualKeys = 16;

}  // namespace

Object::Object(const Node& node) : node_(node), noted_before_(node.noted()) {
  if (!node.is(Kind::object)) static_cast<void>(node.members());  // throws
  known_.reserve(kUsualKeys);
}

void Object::comment(std::string_view key) {
  std::string ignored;
  read_if(key, ignored, &Node::text);
}

void Object::finish() const {
  for (const auto& [key, value] : node_.members()) {
    if (std::ranges::find(known_, key) != known_.end()) continue;
    value.complain(ErrorCode::unknown_key, fmt::format("the key '{}' is unknown. {}", key, suggest(key, known_)));
  }
}

void Object::complain_missing(std::string_view key) const {
  node_.complain(ErrorCode::missing_key, fmt::format("the key '{}' is missing", key));
}

std::vector<double> read_numbers(const Node& node, const Limits& limits) {
  auto values = list_of(number(limits))(node);
  if (node.elements().empty()) node.fail(ErrorCode::invalid_value, "the list is empty; it needs at least one number");
  return values;
}

std::vector<double> read_rising_numbers(const Node& node, const Limits& limits) {
  auto values = read_numbers(node, limits);
  const auto elements = node.elements();
  if (values.size() != elements.size()) return values;  // already reported
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] > values[i - 1]) continue;
    elements[i].complain(ErrorCode::invalid_value,
                         fmt::format("{} must be greater than the value before it, {}", values[i], values[i - 1]));
  }
  return values;
}

void read_unit(Object& object, std::string_view unit) {
  std::string ignored;
  object.read("unit", ignored, [unit](const Node& node) {
    auto found = node.text();
    if (found != unit) node.fail(ErrorCode::wrong_unit, fmt::format("the unit \"{}\" must be \"{}\"", found, unit));
    return found;
  });
}

void read_source(Object& object) {
  std::string ignored;
  object.read("source", ignored, [](const Node& node) {
    auto source = node.text();
    if (source.empty()) node.fail(ErrorCode::invalid_value, "the source is empty; write where the value comes from");
    return source;
  });
}

double read_quantity(const Node& node, std::string_view unit, const Limits& limits) {
  return read_estimate(node, unit, limits).value;
}

}  // namespace mebots::data
