// SPDX-License-Identifier: Apache-2.0
#include "config/json_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace mebots::master {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kTextBlock = 4096;  // bytes

/// Characters that begin in this piece of UTF-8.
std::size_t characters_in(std::string_view piece) {
  return static_cast<std::size_t>(std::count_if(
      piece.begin(), piece.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

/// Offset after the string that begins at `at`.
std::size_t string_end(std::string_view text, std::size_t at) {
  for (++at; at < text.size() && text[at] != '"'; ++at) {
    if (text[at] == '\\') ++at;
  }
  return std::min(at + 1, text.size());
}

/// Offset of the first bracket that opens a level too deep, if there is one. The text need not be valid.
std::optional<std::size_t> too_deep(std::string_view text) {
  std::size_t depth = 0;
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (c == '"') {
      at = string_end(text, at);
      continue;
    }
    if ((c == '{' || c == '[') && ++depth > JsonDocument::kDeepest) return at;
    if ((c == '}' || c == ']') && depth > 0) --depth;
    ++at;
  }
  return std::nullopt;
}

/// Offset of a number that reads as `token` and stands outside of strings.
std::size_t find_number(std::string_view text, std::string_view token) {
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] == '"') {
      at = string_end(text, at);
    } else if (text.substr(at, token.size()) == token) {
      return at;
    } else {
      ++at;
    }
  }
  return 0;
}

/// Walks over the tokens of valid JSON text and calls, in the order of the text,
/// value(offset) for every value (members: offset of the key) and twice(offset, key) for a repeated key.
template <typename Value, typename Twice>
void walk(std::string_view text, Value value, Twice twice) {
  struct Open {
    bool is_object;
    bool key_next;
    std::set<std::string> keys;
  };
  std::vector<Open> open;
  constexpr auto kNoKey = std::string_view::npos;
  std::size_t key_offset = kNoKey;
  const auto begin_value = [&](std::size_t at) {
    value(key_offset == kNoKey ? at : key_offset);
    key_offset = kNoKey;
  };
  for (std::size_t at = text.starts_with("\xEF\xBB\xBF") ? 3 : 0; at < text.size();) {
    const char c = text[at];
    if (c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ':') {
      ++at;
    } else if (c == ',') {
      open.back().key_next = open.back().is_object;
      ++at;
    } else if (c == '{' || c == '[') {
      begin_value(at++);
      open.push_back({c == '{', c == '{', {}});
    } else if (c == '}' || c == ']') {
      open.pop_back();
      ++at;
    } else if (c == '"' && !open.empty() && open.back().key_next) {
      const auto end = string_end(text, at);
      const auto quoted = text.substr(at, end - at);
      auto key = quoted.find('\\') == std::string_view::npos ? std::string(quoted.substr(1, quoted.size() - 2))
                                                             : Json::parse(quoted).get<std::string>();
      if (!open.back().keys.insert(key).second) twice(at, key);
      open.back().key_next = false;
      key_offset = at;
      at = end;
    } else {
      begin_value(at);
      at = c == '"' ? string_end(text, at) : std::min(text.find_first_of(",]} \t\r\n", at), text.size());
    }
  }
}

/// Every value of a tree, an object or list before what is in it.
std::vector<const Json*> all_values(const Json& root) {
  std::vector<const Json*> result;
  std::vector<const Json*> waiting{&root};
  while (!waiting.empty()) {
    const auto* value = waiting.back();
    waiting.pop_back();
    result.push_back(value);
    const auto first = waiting.size();
    if (value->is_structured()) {
      for (const auto& inner : *value) waiting.push_back(&inner);
    }
    std::reverse(waiting.begin() + static_cast<std::ptrdiff_t>(first), waiting.end());
  }
  return result;
}

Json parsed(std::string_view text, const std::string& file, const TextLines& lines) {
  // The library takes a zero byte for the end, and would leave out what follows without a word.
  if (const auto zero = text.find('\0'); zero != std::string_view::npos) {
    throw InputError(
        fmt::format("{}{}: there is a zero byte, so this is no text; save the file as UTF-8", file, lines.place(zero)));
  }
  if (const auto offset = too_deep(text)) {
    throw InputError(fmt::format("{}{}: this is nested more than {} levels deep, which no config needs", file,
                                 lines.place(*offset), JsonDocument::kDeepest));
  }
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    // The library's text reads "[json.exception.parse_error.101] parse error at line 3, column 5: ...".
    std::string what = error.what();
    const auto end_of_tag = what.find(": ");
    if (end_of_tag != std::string::npos) what = what.substr(end_of_tag + 2);
    throw InputError(
        fmt::format("{}{}: this is not JSON: {}", file, lines.place(std::max<std::size_t>(error.byte, 1) - 1), what));
  } catch (const Json::out_of_range& error) {
    // "... number overflow parsing '1e999'"
    const std::string what = error.what();
    const auto quote = what.find('\'');
    const auto token =
        quote == std::string::npos ? std::string() : what.substr(quote + 1, what.rfind('\'') - quote - 1);
    throw InputError(
        fmt::format("{}{}: the number {} is too large", file, lines.place(find_number(text, token)), token));
  }
}

}  // namespace

TextLines::TextLines(std::string text) : text_(std::move(text)) {
  for (std::size_t at = text_.find('\n'); at != std::string::npos; at = text_.find('\n', at + 1)) {
    starts_.push_back(at + 1);
  }
  std::size_t characters = 0;
  for (std::size_t at = 0; at <= text_.size(); at += kTextBlock) {
    characters_.push_back(characters);
    characters += characters_in(std::string_view(text_).substr(at, kTextBlock));
  }
}

std::size_t TextLines::characters_before(std::size_t offset) const {
  const auto block = offset / kTextBlock;
  const auto start = block * kTextBlock;
  return characters_[block] + characters_in(std::string_view(text_).substr(start, offset - start));
}

std::string TextLines::place(std::size_t offset) const {
  offset = std::min(offset, text_.size());
  const auto next = std::upper_bound(starts_.begin(), starts_.end(), offset);
  const auto line = static_cast<std::size_t>(next - starts_.begin());
  const auto column = characters_before(offset) - characters_before(starts_[line - 1]);
  return fmt::format(":{}:{}", line, column + 1);
}

JsonDocument::JsonDocument(std::string_view text, std::string file)
    : file_(std::move(file)), lines_(std::string(text)) {
  value_ = parsed(text, file_, lines_);
  std::vector<std::size_t> offsets;
  walk(
      text, [&](std::size_t offset) { offsets.push_back(offset); },
      [&](std::size_t offset, const std::string& key) {
        throw InputError(fmt::format("{}{}: the key '{}' stands twice in one object; remove one of them", file_,
                                     lines_.place(offset), key));
      });
  const auto values = all_values(value_);
  offsets_.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) offsets_[values[i]] = offsets[i];
}

JsonDocument::JsonDocument(Json value, std::string file, std::map<std::string, std::string> places)
    : value_(std::move(value)), file_(std::move(file)), places_(std::move(places)) {}

std::string JsonDocument::place(const Json& value, const std::string& pointer) const {
  const auto* const shown = pointer.empty() ? "/" : pointer.c_str();
  if (const auto found = offsets_.find(&value); found != offsets_.end()) {
    return fmt::format("{}{}: {}", file_, lines_.place(found->second), shown);
  }
  for (auto outer = pointer;; outer.resize(outer.rfind('/'))) {
    if (const auto found = places_.find(outer); found != places_.end()) {
      return fmt::format("{}: {}: {}", file_, found->second, shown);
    }
    if (outer.empty()) return fmt::format("{}: {}", file_, shown);
  }
}

}  // namespace mebots::master
