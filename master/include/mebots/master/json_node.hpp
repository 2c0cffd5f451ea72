// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/master/input_error.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mebots::master {

/// One value inside a JSON file together with its place, so that every complaint names file and JSON
/// pointer. Keeps the order of an object's keys. All readers throw InputError when the value is of
/// another kind than asked for.
class JsonNode {
 public:
  /// `value` must outlive the node.
  JsonNode(const nlohmann::ordered_json& value, std::string file, std::string pointer = {})
      : value_(&value), file_(std::move(file)), pointer_(std::move(pointer)) {}

  /// Checks that this is an object with no other keys than these; a typo is answered by the nearest key.
  const JsonNode& expect_keys(std::span<const std::string_view> allowed) const;
  const JsonNode& expect_keys(std::initializer_list<std::string_view> allowed) const {
    return expect_keys(std::span(allowed.begin(), allowed.size()));
  }
  /// Throws when the key is missing.
  JsonNode at(std::string_view key) const;
  std::optional<JsonNode> find(std::string_view key) const;
  bool has(std::string_view key) const { return value_->is_object() && value_->contains(key); }

  std::vector<std::pair<std::string, JsonNode>> members() const;
  std::vector<JsonNode> elements() const;
  std::string string() const;
  double number() const;
  bool boolean() const;
  /// A time in seconds that is a whole number of nanoseconds.
  std::int64_t nanoseconds() const;

  const nlohmann::ordered_json& value() const { return *value_; }
  /// "file.json: /pointer/to/it"
  std::string place() const;
  [[noreturn]] void fail(const std::string& what) const;

 private:
  JsonNode child(const std::string& key, const nlohmann::ordered_json& value) const;
  [[noreturn]] void fail_kind(std::string_view wanted) const;

  const nlohmann::ordered_json* value_;
  std::string file_;
  std::string pointer_;
};

/// Parses JSON text; refuses broken syntax (with line and column) and an object that has a key twice.
nlohmann::ordered_json parse_json(std::string_view text, const std::string& file);

}  // namespace mebots::master
