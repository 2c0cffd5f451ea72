// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/input_error.hpp"

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

class JsonDocument;

/// One value inside a JsonDocument together with its place, so that every complaint names file, line, column
/// and JSON pointer. Keeps the order of an object's keys. All readers throw InputError when the value is of
/// another kind than asked for. Must not outlive the document.
class JsonNode {
 public:
  JsonNode(const nlohmann::ordered_json& value, const JsonDocument& document, std::string pointer)
      : value_(&value), document_(&document), pointer_(std::move(pointer)) {}

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
  const std::string& pointer() const { return pointer_; }
  /// "file.json:12:5: /pointer/to/it"
  std::string place() const;
  [[noreturn]] void fail(const std::string& what) const;

 private:
  JsonNode child(const std::string& key, const nlohmann::ordered_json& value) const;
  [[noreturn]] void fail_kind(std::string_view wanted) const;

  const nlohmann::ordered_json* value_;
  const JsonDocument* document_;
  std::string pointer_;
};

/// One step of a JSON pointer (RFC 6901).
std::string pointer_step(std::string_view key);

}  // namespace mebots::master
