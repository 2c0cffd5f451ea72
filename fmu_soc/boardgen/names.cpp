// SPDX-License-Identifier: Apache-2.0
#include "headers.hpp"

#include <cctype>
#include <vector>

namespace mebots::boardgen {
namespace {

/// Splits a name into words in lower case: FlightMode becomes {"flight", "mode"}, and TIME_LO becomes {"time", "lo"}.
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words(1);
  char previous = '_';
  for (const char c : name) {
    const bool separates = std::isalnum(static_cast<unsigned char>(c)) == 0;
    const bool upper_after_lower =
        std::isupper(static_cast<unsigned char>(c)) != 0 && (std::islower(static_cast<unsigned char>(previous)) != 0);
    if ((separates || upper_after_lower) && !words.back().empty()) words.emplace_back();
    if (!separates) words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    previous = c;
  }
  return words;
}

std::string joined(const std::string& name) {
  std::string result;
  for (const auto& word : words_of(name)) result += (result.empty() ? "" : "_") + word;
  return result;
}

}  // namespace

std::string macro_case(const std::string& name) {
  auto result = joined(name);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

std::string camel_case(const std::string& name) {
  std::string result;
  for (auto word : words_of(name)) {
    if (word.empty()) continue;
    word[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(word[0])));
    result += word;
  }
  return result;
}

std::string snake_case(const std::string& name) {
  return joined(name);
}

}  // namespace mebots::boardgen
