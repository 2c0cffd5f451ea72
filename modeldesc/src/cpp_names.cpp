// SPDX-License-Identifier: Apache-2.0
#include "generate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace mebots::modeldesc {
namespace {

constexpr auto kKeywords = std::to_array<std::string_view>(
    {"alignas",     "alignof",  "and",        "and_eq",    "asm",       "auto",         "bitand",
     "bitor",       "bool",     "break",      "case",      "catch",     "char",         "char16_t",
     "char32_t",    "char8_t",  "class",      "co_await",  "co_return", "co_yield",     "compl",
     "concept",     "const",    "const_cast", "consteval", "constexpr", "constinit",    "continue",
     "decltype",    "default",  "delete",     "do",        "double",    "dynamic_cast", "else",
     "enum",        "explicit", "export",     "extern",    "false",     "float",        "for",
     "friend",      "goto",     "if",         "inline",    "int",       "long",         "mutable",
     "namespace",   "new",      "noexcept",   "not",       "not_eq",    "nullptr",      "operator",
     "or",          "or_eq",    "private",    "protected", "public",    "register",     "reinterpret_cast",
     "requires",    "return",   "short",      "signed",    "sizeof",    "static",       "static_assert",
     "static_cast", "struct",   "switch",     "template",  "this",      "thread_local", "throw",
     "true",        "try",      "typedef",    "typeid",    "typename",  "union",        "unsigned",
     "using",       "virtual",  "void",       "volatile",  "wchar_t",   "while",        "xor",
     "xor_eq"});

bool is_letter(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Removes a word (a letter, followed by letters and digits) from the start of `text`. Returns false if `text` does not
/// start with a word.
bool take_word(std::string_view& text) {
  if (text.empty() || !is_letter(text.front())) return false;
  const auto* const end = std::ranges::find_if_not(text, [](char c) { return is_letter(c) || is_digit(c); });
  text.remove_prefix(static_cast<std::size_t>(end - text.begin()));
  return true;
}

bool take_number(std::string_view& text) {
  const auto* const end = std::ranges::find_if_not(text, is_digit);
  const auto digits = static_cast<std::size_t>(end - text.begin());
  text.remove_prefix(digits);
  return digits != 0;
}

bool take(std::string_view& text, std::string_view mark) {
  if (!text.starts_with(mark)) return false;
  text.remove_prefix(mark.size());
  return true;
}

/// Removes an optional index, such as `[1]` or `[1,2]`, from the start of `text`. Returns false if the index is
/// malformed.
bool take_indices(std::string_view& text) {
  if (!take(text, "[")) return true;
  do {
    if (!take_number(text)) return false;
  } while (take(text, ","));
  return take(text, "]");
}

}  // namespace

bool is_cpp_identifier(std::string_view name) {
  std::string_view rest = name;
  return take_word(rest) && rest.empty() && std::ranges::find(kKeywords, name) == kKeywords.end();
}

bool is_cpp_namespace(std::string_view name) {
  const auto end = name.find("::");
  if (end == std::string_view::npos) return is_cpp_identifier(name);
  return is_cpp_identifier(name.substr(0, end)) && is_cpp_namespace(name.substr(end + 2));
}

bool is_structured_name(std::string_view name) {
  do {
    if (!take_word(name) || !take_indices(name)) return false;
  } while (take(name, "."));
  return name.empty();
}

std::string to_cpp_name(std::string_view fmi_name) {
  std::string result;
  for (const char c : fmi_name) {
    const bool mark = c == '.' || c == '[' || c == ']' || c == ',';
    if (!mark)
      result += c;
    else if (!result.empty() && result.back() != '_')
      result += '_';
  }
  while (!result.empty() && result.back() == '_') result.pop_back();
  return result;
}

std::string cpp_literal(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      result += fmt::format("\\{}", c);
    else if (byte < 0x20 || byte == 0x7F)
      result += fmt::format("\\{:03o}", byte);
    else
      result += c;
  }
  return result + '"';
}

}  // namespace mebots::modeldesc
