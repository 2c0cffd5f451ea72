// SPDX-License-Identifier: Apache-2.0
#include "schema_rules.hpp"

#include "mebots/error.hpp"
#include "mebots/fmi/variable_kinds.hpp"
#include "mebots/parsed_number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <span>

namespace mebots::check {
namespace {

constexpr std::string_view kSpace = " \t\r\n";
constexpr std::string_view kFlagWords[] = {"true", "false", "0", "1"};
constexpr std::string_view kNamingWords[] = {"flat", "structured"};
constexpr std::string_view kCausality3Words[] = {
    "parameter", "calculatedParameter", "structuralParameter", "input", "output", "local", "independent"};
constexpr std::string_view kIntervalWords[] = {"constant", "fixed", "tunable", "changing", "countdown", "triggered"};
constexpr std::string_view kDependencyWords[] = {"dependent", "constant", "fixed", "tunable", "discrete"};

template <const auto& kWords>
bool is_one_of(std::string_view text) {
  return std::ranges::find(kWords, text) != std::end(kWords);
}

/// Joins words to a text such as "a, b or c".
std::string either(std::span<const std::string_view> words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += fmt::format("{}{}", i == 0 ? "" : i + 1 == words.size() ? " or " : ", ", words[i]);
  return text;
}

template <typename T>
bool is_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  return parsed_number<T>(text).has_value();
}

/// True for numbers of XML Schema. INF and NaN must have exactly this form.
bool is_real(std::string_view text) {
  static constexpr std::string_view kNotFinite[] = {"INF", "-INF", "NaN"};
  return is_one_of<kNotFinite>(text) || (is_number<double>(text) && text.find_first_of("iInN") == std::string::npos);
}

/// Removes leading digits from the text and returns their number.
std::size_t take_digits(std::string_view& text) {
  const auto end = std::min(text.find_first_not_of("0123456789"), text.size());
  text.remove_prefix(end);
  return end;
}

/// True for times such as 2024-05-01T12:00:00, with optional fraction and zone. Does not use std::regex, which recurses
/// for every character.
bool is_date(std::string_view text) {
  const auto take = [&](std::string_view shape) {
    if (text.size() < shape.size()) return false;
    for (std::size_t i = 0; i < shape.size(); ++i) {
      const bool digit = text[i] >= '0' && text[i] <= '9';
      if (shape[i] == '0' ? !digit : text[i] != shape[i]) return false;
    }
    text.remove_prefix(shape.size());
    return true;
  };
  if (text.starts_with('-')) text.remove_prefix(1);
  if (take_digits(text) < 4 || !take("-00-00T00:00:00")) return false;
  if (text.starts_with('.')) {
    text.remove_prefix(1);
    if (take_digits(text) == 0) return false;
  }
  return text.empty() || ((take("Z") || take("+00:00") || take("-00:00")) && text.empty());
}

template <bool (*holds)(std::string_view)>
bool is_list(std::string_view text) {
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    const auto end = std::min(text.find_first_of(kSpace), text.size());
    if (!holds(text.substr(0, end))) return false;
    text.remove_prefix(end);
  }
  return true;
}

bool is_hexadecimal(std::string_view text) {
  return text.size() % 2 == 0 && text.find_first_not_of("0123456789abcdefABCDEF") == std::string_view::npos;
}

/// True for versions 3.x such as 3.0, 3.0.2 or 3.1-alpha.1. Numbers must not have leading zeros.
bool is_fmi3_version(std::string_view text) {
  if (!text.starts_with("3.")) return false;
  text.remove_prefix(2);
  const auto number = [&] {
    const bool zero = text.starts_with('0');
    const auto digits = take_digits(text);
    return digits == 1 || (digits > 1 && !zero);
  };
  if (!number()) return false;
  if (text.starts_with('.')) {
    text.remove_prefix(1);
    if (!number()) return false;
  }
  return text.empty() || (text.starts_with('-') && text.size() > 1);
}

}  // namespace

const Form& find_form(std::string_view name) {
  static const Form kForms[] = {
      {"text", [](std::string_view) { return true; }, "a text"},
      {"number", is_real, "a number such as 0.5, 1e-3 or INF"},
      {"whole", is_number<std::int32_t>, "a whole number of 32 bits"},
      {"count", is_number<std::uint32_t>, "a whole number from 0 to 4294967295"},
      {"flag", is_one_of<kFlagWords>, "true or false"},
      {"date", is_date, "a date and time such as 2024-05-01T12:00:00Z"},
      {"naming", is_one_of<kNamingWords>, either(kNamingWords)},
      {"causality", is_one_of<fmi::kCausalityWords2>, either(fmi::kCausalityWords2)},
      {"variability", is_one_of<fmi::kVariabilityWords>, either(fmi::kVariabilityWords)},
      {"initial", is_one_of<fmi::kInitialWords>, either(fmi::kInitialWords)},
      {"dependencies", is_list<is_one_of<kDependencyWords>>, "a list of " + either(kDependencyWords)},
      // Forms of values that only FMI 1.0 has.
      {"causality1", is_one_of<fmi::kCausalityWords1>, either(fmi::kCausalityWords1)},
      {"variability1", is_one_of<fmi::kVariabilityWords1>, either(fmi::kVariabilityWords1)},
      {"alias1", is_one_of<fmi::kAliasWords1>, either(fmi::kAliasWords1)},
      // Forms of values that only FMI 3.0 has.
      {"fmi3", is_fmi3_version, "3.0, or a later 3.x"},
      {"causality3", is_one_of<kCausality3Words>, either(kCausality3Words)},
      {"interval", is_one_of<kIntervalWords>, either(kIntervalWords)},
      {"int8", is_number<std::int8_t>, "a whole number of 8 bits"},
      {"uint8", is_number<std::uint8_t>, "a whole number from 0 to 255"},
      {"int16", is_number<std::int16_t>, "a whole number of 16 bits"},
      {"uint16", is_number<std::uint16_t>, "a whole number from 0 to 65535"},
      {"int64", is_number<std::int64_t>, "a whole number of 64 bits"},
      {"uint64", is_number<std::uint64_t>, "a whole number of 64 bits, at least 0"},
      {"hex", is_hexadecimal, "bytes as pairs of hexadecimal digits"},
      {"numbers", is_list<is_real>, "numbers with spaces between"},
      {"flags", is_list<is_one_of<kFlagWords>>, "true or false, once per element"},
      {"int8s", is_list<is_number<std::int8_t>>, "whole numbers of 8 bits"},
      {"uint8s", is_list<is_number<std::uint8_t>>, "whole numbers from 0 to 255"},
      {"int16s", is_list<is_number<std::int16_t>>, "whole numbers of 16 bits"},
      {"uint16s", is_list<is_number<std::uint16_t>>, "whole numbers from 0 to 65535"},
      {"wholes", is_list<is_number<std::int32_t>>, "whole numbers of 32 bits"},
      {"counts", is_list<is_number<std::uint32_t>>, "whole numbers from 0 to 4294967295"},
      {"int64s", is_list<is_number<std::int64_t>>, "whole numbers of 64 bits"},
      {"uint64s", is_list<is_number<std::uint64_t>>, "whole numbers of 64 bits, at least 0"},
  };
  const auto* const found = std::ranges::find(kForms, name, &Form::name);
  if (found == std::end(kForms))
    throw Error(ErrorCode::unknown_name, fmt::format("no form of values is called '{}'", name));
  return *found;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

}  // namespace mebots::check
