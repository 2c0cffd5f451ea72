// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/json_node.hpp"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace mebots::master {

/// Where the lines of a text start, to turn an offset into line and column; fast also where all is one long line.
class TextLines {
 public:
  TextLines() : TextLines(std::string()) {}
  explicit TextLines(std::string text);

  /// ":line:column", both from 1; columns count characters of UTF-8.
  std::string place(std::size_t offset) const;

 private:
  std::size_t characters_before(std::size_t offset) const;

  std::string text_;
  std::vector<std::size_t> starts_{0};
  std::vector<std::size_t> characters_;  // of UTF-8 before each block of the text
};

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
  TextLines lines_;
  std::unordered_map<const nlohmann::ordered_json*, std::size_t> offsets_;  // of values in the text
  std::map<std::string, std::string> places_;
};

}  // namespace mebots::master
