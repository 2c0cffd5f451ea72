// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/document.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::data {

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

/// One value. The values of a document stand in the order of its text, an object or list before what is in it. The
/// first inside of value i is i + 1, and behind a value with all that is in it comes `end`.
struct Value {
  Kind kind = Kind::null;
  bool flag = false;
  bool is_literal = false;   // a whole number without point and exponent
  bool negative = false;     // of a whole number
  std::size_t parent = 0;    // of the root: itself
  std::size_t end = 0;       // index
  std::size_t position = 0;  // in its list
  std::size_t offset = 0;    // bytes into the text, of a member that of its key; without a text its own index
  std::uint64_t whole = 0;   // of a whole number, in two's complement
  double number = 0;         // of any number
  std::string key;           // of a member
  std::string text;          // of a text
};

struct Document::Content {
  std::string name;
  std::optional<TextLines> lines;  // of the text; none for a value without one
  std::vector<Value> values;
  std::map<std::string, std::string> places;  // by JSON pointer, of a value without a text
  std::vector<Mistake> mistakes;
};

/// Takes the text apart. Throws Mistakes when it is not JSON; notes each key that occurs twice in one object.
std::vector<Value> parse(std::string_view text, const std::string& name, const TextLines& lines,
                         std::vector<Mistake>& mistakes);

/// The values of JSON that is in memory already.
std::vector<Value> values_of(const nlohmann::ordered_json& json);

/// A zero byte, which a file can name by \u0000, would end a mistake for who takes it from what(): as JSON names it.
std::string without_zero_bytes(std::string_view text);

/// Of the value of this index; empty for the root.
std::string pointer_of(const std::vector<Value>& values, std::size_t index);

}  // namespace mebots::data
