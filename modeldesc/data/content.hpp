// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/document.hpp"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::data {

/// Stores the offset at which each line of a text starts. Converts an offset to line and column.
class TextLines {
 public:
  TextLines() : TextLines(std::string()) {}
  explicit TextLines(std::string text);

  /// Returns the place as ":line:column". Both numbers start at 1. Columns count UTF-8 characters.
  std::string place(std::size_t offset) const;

 private:
  std::size_t characters_before(std::size_t offset) const;

  std::string text_;
  std::vector<std::size_t> starts_{0};
  std::vector<std::size_t> characters_;  // UTF-8 characters before each block of the text
};

/// A value of the document. The list of values has the order of the text: each container precedes its contents. If
/// value i has contents, its first element is value i + 1. `end` is the index after its last descendant.
struct Value {
  Kind kind = Kind::null;
  bool flag = false;
  bool is_literal = false;   // a whole number without point and exponent
  bool negative = false;     // a whole number with a minus sign
  std::size_t parent = 0;    // index of the container; the root's is its own
  std::size_t end = 0;       // index
  std::size_t position = 0;  // position in its container
  std::size_t offset = 0;    // byte offset in the text (for a member, of its key); without a text, the value's own
                             // index
  std::uint64_t whole = 0;   // a whole number, in two's complement
  double number = 0;         // any number
  std::string key;           // key of a member
  std::string text;          // content of a text
};

struct Document::Content {
  std::string name;
  std::optional<TextLines> lines;  // empty if the document was not read from a text
  std::vector<Value> values;
  std::map<std::string, std::string> places;  // if the document was not read from a text: place of a value, by JSON
                                              // pointer
  std::vector<Mistake> mistakes;
};

/// Parses the text. Throws Mistakes if it is not JSON. Adds a mistake for each key that occurs twice in an object.
std::vector<Value> parse(std::string_view text, const std::string& name, const TextLines& lines,
                         std::vector<Mistake>& mistakes);

/// Converts JSON in memory to a list of values. The comment of Value describes their order.
std::vector<Value> values_of(const nlohmann::ordered_json& json);

/// Replaces zero bytes by the JSON escape \u0000. A zero byte would end the message of what() early.
std::string without_zero_bytes(std::string_view text);

/// Returns the JSON pointer of the value with this index; empty for the root.
std::string pointer_of(const std::vector<Value>& values, std::size_t index);

}  // namespace mebots::data
