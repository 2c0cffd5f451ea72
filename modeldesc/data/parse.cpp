// SPDX-License-Identifier: Apache-2.0
// Finds the place of each value. The JSON library calls a function for every value, but does not report the value's
// offset. Therefore a cursor moves through the same text by one token per call. The library has already validated the
// text before the cursor, so the cursor needs few rules of JSON.
#include "content.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace mebots::data {
namespace {

/// Returns the offset after the string that starts at `at`.
std::size_t string_end(std::string_view text, std::size_t at) {
  for (++at; at < text.size() && text[at] != '"'; ++at) {
    if (text[at] == '\\') ++at;
  }
  return std::min(at + 1, text.size());
}

constexpr std::size_t kBytesAValue = 16;  // lower bound in most texts, key included

void put_whole(Value& value, std::uint64_t whole, bool negative, double number) {
  value.kind = Kind::whole_number;
  value.whole = whole;
  value.is_literal = true;
  value.negative = negative;
  value.number = number;
}

void put_integer(Value& value, std::int64_t whole) {
  put_whole(value, static_cast<std::uint64_t>(whole), whole < 0, static_cast<double>(whole));
}

void put_unsigned(Value& value, std::uint64_t whole) {
  put_whole(value, whole, false, static_cast<double>(whole));
}

void put_float(Value& value, double number) {
  constexpr double kAllWhole = 9007199254740992;  // 2^53: the largest double below which all whole numbers are exact
  const bool is_whole = number == std::floor(number) && std::abs(number) <= kAllWhole;
  value.kind = is_whole ? Kind::whole_number : Kind::number;
  value.number = number;
  if (!is_whole) return;
  value.whole = static_cast<std::uint64_t>(static_cast<std::int64_t>(number));
  value.negative = number < 0;
}

class Builder : public nlohmann::json_sax<nlohmann::json> {
 public:
  Builder(std::string_view text, const std::string& name, const TextLines& lines, std::vector<Mistake>& mistakes)
      : text_(text), name_(name), lines_(lines), mistakes_(mistakes) {
    if (text_.starts_with("\xEF\xBB\xBF")) cursor_ = 3;
    values_.reserve(text.size() / kBytesAValue);  // growing costs as much as parsing
  }

  std::vector<Value> values() { return std::move(values_); }

  bool null() override {
    begin_value(Kind::null);
    return true;
  }
  bool boolean(bool flag) override {
    begin_value(Kind::boolean).flag = flag;
    return true;
  }
  bool number_integer(std::int64_t whole) override {
    put_integer(begin_value(Kind::whole_number), whole);
    return true;
  }
  bool number_unsigned(std::uint64_t whole) override {
    put_unsigned(begin_value(Kind::whole_number), whole);
    return true;
  }
  bool number_float(double number, const std::string& /*token*/) override {
    put_float(begin_value(Kind::number), number);
    return true;
  }
  bool string(std::string& text) override {
    begin_value(Kind::text).text = std::move(text);
    return true;
  }
  bool binary(nlohmann::json::binary_t& /*value*/) override { return false; }  // JSON text has none

  bool start_object(std::size_t /*size*/) override { return open(Kind::object); }
  bool start_array(std::size_t /*size*/) override { return open(Kind::list); }
  bool end_object() override {
    const auto object = open_.back().value;
    close();
    note_keys_that_stand_twice(object);
    return true;
  }
  bool end_array() override { return close(); }

  bool key(std::string& key) override {
    key_offset_ = next_token();
    key_ = std::move(key);
    has_key_ = true;
    return true;
  }

  bool parse_error(std::size_t position, const std::string& token, const nlohmann::json::exception& error) override {
    constexpr int kNumberOverflow = 406;
    if (error.id == kNumberOverflow) {
      refuse(ErrorCode::value_out_of_range, next_token(), fmt::format("the number {} is too large", token));
    }
    // Removes the prefix of the library's message: "[json.exception.parse_error.101] parse error at line 3, column 5:
    // ..."
    std::string what = error.what();
    const auto end_of_tag = what.find(": ");
    if (end_of_tag != std::string::npos) what = what.substr(end_of_tag + 2);
    refuse(ErrorCode::syntax_error, std::max<std::size_t>(position, 1) - 1, "this is not JSON: " + what);
  }

  [[noreturn]] void refuse(ErrorCode code, std::size_t offset, const std::string& what) {
    note(code, offset, what);
    throw Mistakes({mistakes_.back()});
  }

 private:
  struct Open {
    std::size_t value;
    std::size_t size = 0;
  };

  void note(ErrorCode code, std::size_t offset, std::string_view what, const std::string& pointer = {}) {
    auto place = name_ + lines_.place(offset) + (pointer.empty() ? "" : ": " + pointer);
    mistakes_.push_back({code, without_zero_bytes(place), without_zero_bytes(what), offset});
  }

  /// Returns the offset of the token that the parser read last. Moves the cursor past the token.
  std::size_t next_token() {
    const auto start = std::min(text_.find_first_not_of(" \t\r\n,:", cursor_), text_.size());
    if (start == text_.size()) return start;
    const char first = text_[start];
    if (first == '"') {
      cursor_ = string_end(text_, start);
    } else if (first == '{' || first == '}' || first == '[' || first == ']') {
      cursor_ = start + 1;
    } else {
      cursor_ = std::min(text_.find_first_of(",]} \t\r\n", start), text_.size());
    }
    return start;
  }

  Value& begin_value(Kind kind) {
    const auto offset = next_token();
    Value value;
    value.kind = kind;
    value.offset = has_key_ ? key_offset_ : offset;
    value.end = values_.size() + 1;
    if (!open_.empty()) {
      value.parent = open_.back().value;
      value.position = open_.back().size++;
    }
    if (has_key_) value.key = std::move(key_);
    has_key_ = false;
    return values_.emplace_back(std::move(value));
  }

  bool open(Kind kind) {
    if (open_.size() == Document::kDeepest) {
      refuse(ErrorCode::syntax_error, next_token(),
             fmt::format("this is nested more than {} levels deep; no file of MEbots needs more", Document::kDeepest));
    }
    begin_value(kind);
    open_.push_back({values_.size() - 1});
    return true;
  }

  bool close() {
    next_token();
    values_[open_.back().value].end = values_.size();
    open_.pop_back();
    return true;
  }

  /// Reports duplicate keys of a complete object. Compares few members in pairs, and sorts many members.
  void note_keys_that_stand_twice(std::size_t object) {
    constexpr std::size_t kFew = 16;
    members_.clear();
    for (auto i = object + 1; i < values_[object].end; i = values_[i].end) members_.push_back(i);
    const auto same = [&](std::size_t a, std::size_t b) { return values_[a].key == values_[b].key; };
    if (members_.size() > kFew) {
      std::ranges::sort(members_, {}, [&](std::size_t i) { return std::pair(std::string_view(values_[i].key), i); });
      for (std::size_t i = 1; i < members_.size(); ++i) {
        if (same(members_[i - 1], members_[i])) note_second(members_[i]);
      }
      return;
    }
    for (auto second = members_.begin(); second != members_.end(); ++second) {
      if (std::any_of(members_.begin(), second, [&](std::size_t first) { return same(first, *second); })) {
        note_second(*second);
      }
    }
  }

  void note_second(std::size_t member) {
    const auto& value = values_[member];
    note(ErrorCode::duplicate_key, value.offset,
         fmt::format("the key '{}' occurs twice in one object; remove one of them", value.key),
         pointer_of(values_, value.parent) + pointer_step(value.key));
  }

  std::string_view text_;
  const std::string& name_;
  const TextLines& lines_;
  std::vector<Mistake>& mistakes_;
  std::vector<std::size_t> members_;  // of the last closed object
  std::size_t cursor_ = 0;
  std::vector<Value> values_;
  std::vector<Open> open_;
  std::string key_;
  std::size_t key_offset_ = 0;
  bool has_key_ = false;
};

class Lister {
 public:
  std::vector<Value> values() { return std::move(values_); }

  /// `position` is the index of the value in its list or object.
  void add(const nlohmann::ordered_json& json, std::size_t parent, std::size_t position, std::string key) {
    const auto index = values_.size();
    auto& value = values_.emplace_back();
    value.parent = parent;
    value.position = position;
    value.offset = index;
    value.key = std::move(key);
    put(value, json);
    std::size_t place = 0;
    if (json.is_object()) {
      for (const auto& [name, member] : json.items()) add(member, index, place++, name);
    } else if (json.is_array()) {
      for (const auto& element : json) add(element, index, place++, {});
    }
    values_[index].end = values_.size();
  }

 private:
  static void put(Value& value, const nlohmann::ordered_json& json) {
    using Type = nlohmann::ordered_json::value_t;
    switch (json.type()) {
      case Type::object:
        value.kind = Kind::object;
        break;
      case Type::array:
        value.kind = Kind::list;
        break;
      case Type::string:
        value.kind = Kind::text;
        value.text = json.get_ref<const std::string&>();
        break;
      case Type::boolean:
        value.kind = Kind::boolean;
        value.flag = json.get<bool>();
        break;
      case Type::number_integer:
        put_integer(value, json.get<std::int64_t>());
        break;
      case Type::number_unsigned:
        put_unsigned(value, json.get<std::uint64_t>());
        break;
      case Type::number_float:
        if (std::isfinite(json.get<double>())) put_float(value, json.get<double>());
        break;
      default:
        break;  // null
    }
  }

  std::vector<Value> values_;
};

}  // namespace

std::vector<Value> values_of(const nlohmann::ordered_json& json) {
  Lister lister;
  lister.add(json, 0, 0, {});
  return lister.values();
}

std::vector<Value> parse(std::string_view text, const std::string& name, const TextLines& lines,
                         std::vector<Mistake>& mistakes) {
  Builder builder(text, name, lines, mistakes);
  // Refuses a zero byte, because the library would treat it as the end of the text and ignore the rest.
  if (const auto zero = text.find('\0'); zero != std::string_view::npos) {
    builder.refuse(ErrorCode::syntax_error, zero,
                   "this contains a zero byte, so it is not JSON text; save the file as UTF-8");
  }
  nlohmann::json::sax_parse(text, &builder);
  return builder.values();
}

}  // namespace mebots::data
