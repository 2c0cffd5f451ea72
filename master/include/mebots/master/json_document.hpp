// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/master/json_node.hpp"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>

namespace mebots::master {

/// A JSON text that knows where each of its values stands, so that every complaint names file, line, column
/// and JSON pointer. Lives as long as any JsonNode of it.
class JsonDocument {
 public:
  /// Deeper texts are refused: no config needs more, and whoever walks one may recurse.
  static constexpr std::size_t kDeepest = 100;

  /// Throws InputError for text that is not JSON (RFC 8259), that is nested deeper than kDeepest, or that has
  /// an object with a key twice.
  JsonDocument(std::string_view text, std::string file);

  /// JSON that was made from something else, an SSP say. `places` says for a JSON pointer where in `file` its
  /// value was written; a pointer without a place of its own has that of what it is in.
  JsonDocument(nlohmann::ordered_json value, std::string file, std::map<std::string, std::string> places);

  JsonDocument(const JsonDocument&) = delete;
  JsonDocument& operator=(const JsonDocument&) = delete;

  JsonNode root() const { return {value_, *this, {}}; }
  const nlohmann::ordered_json& value() const { return value_; }

  /// "file.json:12:5: /pointer/to/it". A member stands where its key stands.
  std::string place(const nlohmann::ordered_json& value, const std::string& pointer) const;

 private:
  nlohmann::ordered_json value_;
  std::string file_;
  std::unordered_map<const nlohmann::ordered_json*, std::string> positions_;  // ":line:column"
  std::map<std::string, std::string> places_;
};

}  // namespace mebots::master
