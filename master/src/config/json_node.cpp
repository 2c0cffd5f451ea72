// SPDX-License-Identifier: Apache-2.0
#include "config/json_node.hpp"

#include "base/time.hpp"
#include "config/json_document.hpp"
#include "mebots/nearest_names.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace mebots::master {
namespace {

using Json = nlohmann::ordered_json;

std::string shortened(const Json& value) {
  constexpr std::size_t kLongest = 60;
  auto text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return text;
}

}  // namespace

std::string pointer_step(std::string_view key) {
  std::string text = "/";
  for (const char c : key) {
    if (c == '~') {
      text += "~0";
    } else if (c == '/') {
      text += "~1";
    } else {
      text += c;
    }
  }
  return text;
}

std::string JsonNode::place() const {
  return document_->place(*value_, pointer_);
}

void JsonNode::fail(const std::string& what) const {
  throw InputError(fmt::format("{}: {}", place(), what));
}

void JsonNode::fail_kind(std::string_view wanted) const {
  fail(fmt::format("{} is expected here, not {}", wanted, shortened(*value_)));
}

JsonNode JsonNode::child(const std::string& key, const Json& value) const {
  return {value, *document_, pointer_ + pointer_step(key)};
}

const JsonNode& JsonNode::expect_keys(std::span<const std::string_view> allowed) const {
  if (!value_->is_object()) fail_kind("an object");
  const std::vector<std::string> names(allowed.begin(), allowed.end());
  for (const auto& [key, value] : value_->items()) {
    if (std::find(names.begin(), names.end(), key) == names.end()) {
      child(key, value).fail(fmt::format("the key '{}' is unknown. {}", key, suggest(key, names)));
    }
  }
  return *this;
}

JsonNode JsonNode::at(std::string_view key) const {
  if (!value_->is_object()) fail_kind("an object");
  const auto found = value_->find(key);
  if (found == value_->end()) fail(fmt::format("the key '{}' is missing", key));
  return child(std::string(key), *found);
}

std::optional<JsonNode> JsonNode::find(std::string_view key) const {
  if (!has(key)) return std::nullopt;
  return at(key);
}

std::vector<std::pair<std::string, JsonNode>> JsonNode::members() const {
  if (!value_->is_object()) fail_kind("an object");
  std::vector<std::pair<std::string, JsonNode>> result;
  for (const auto& [key, value] : value_->items()) result.emplace_back(key, child(key, value));
  return result;
}

std::vector<JsonNode> JsonNode::elements() const {
  if (!value_->is_array()) fail_kind("a list");
  std::vector<JsonNode> result;
  for (std::size_t i = 0; i < value_->size(); ++i) result.push_back(child(std::to_string(i), (*value_)[i]));
  return result;
}

std::string JsonNode::string() const {
  if (!value_->is_string()) fail_kind("a text");
  return value_->get<std::string>();
}

double JsonNode::number() const {
  if (!value_->is_number()) fail_kind("a number");
  return value_->get<double>();
}

bool JsonNode::boolean() const {
  if (!value_->is_boolean()) fail_kind("true or false");
  return value_->get<bool>();
}

std::int64_t JsonNode::nanoseconds() const {
  const auto time = to_nanoseconds(number());
  if (!time) {
    fail(fmt::format("{} s is not a whole number of nanoseconds (or longer than {} s); give a time such as 0.002",
                     shortened(*value_), kLongestTimeS));
  }
  return *time;
}

}  // namespace mebots::master
