// SPDX-License-Identifier: Apache-2.0
#include "fmi/process/process_state.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <map>
#include <string_view>

namespace mebots::master {
namespace {

constexpr std::size_t kMostTexts = 8;
constexpr std::size_t kLongestValue = 80;

std::string_view name_of(std::string_view entry) {
  return entry.substr(0, entry.find('='));
}

std::string_view value_of(std::string_view entry) {
  const auto equals = entry.find('=');
  return equals == std::string_view::npos ? std::string_view() : entry.substr(equals + 1);
}

std::string shown_value(const char* entry) {
  const auto value = value_of(entry);
  return fmt::format("'{}{}'", value.substr(0, kLongestValue), value.size() > kLongestValue ? "..." : "");
}

/// Returns the entry of each environment variable. If a name occurs twice, returns the first entry, like getenv().
std::map<std::string, char*, std::less<>> entries_by_name() {
  std::map<std::string, char*, std::less<>> entries;
  if (environ == nullptr) return entries;
  for (char** entry = environ; *entry != nullptr; ++entry) entries.emplace(name_of(*entry), *entry);
  return entries;
}

void shorten(std::vector<std::string>& texts) {
  if (texts.size() <= kMostTexts) return;
  const auto more = texts.size() - kMostTexts;
  texts.resize(kMostTexts);
  texts.push_back(fmt::format("{} more environment variable{} changed (put back)", more, more == 1 ? "" : "s"));
}

}  // namespace

EnvironmentVariables EnvironmentVariables::now() {
  EnvironmentVariables copy;
  if (environ == nullptr) return copy;
  for (char** entry = environ; *entry != nullptr; ++entry) copy.entries_.push_back({*entry, *entry});
  return copy;
}

std::vector<std::string> EnvironmentVariables::restore() const {
  const auto is_same = [](const Entry& before, const char* now) {
    return now != nullptr && before.place == now && before.text == now;
  };
  std::size_t same = 0;
  while (environ != nullptr && same < entries_.size() && is_same(entries_[same], environ[same])) ++same;
  if (same == entries_.size() && (environ == nullptr || environ[same] == nullptr)) return {};

  std::vector<std::string> texts;
  auto now = entries_by_name();
  std::map<std::string, bool, std::less<>> seen;
  for (const auto& before : entries_) {
    const std::string name(name_of(before.text));
    if (!seen.emplace(name, true).second) continue;
    const auto found = now.find(name);
    const char* entry = found == now.end() ? nullptr : found->second;
    if (found != now.end()) now.erase(found);
    if (is_same(before, entry)) continue;
    if (entry == nullptr) {
      texts.push_back(fmt::format("environment variable {} was removed (put back)", name));
    } else if (before.text != entry) {
      texts.push_back(fmt::format("environment variable {} became {} (put back)", name, shown_value(entry)));
    }
    // Also replaces an equal text at another address, because it may be in the FMU's memory.
    setenv(name.c_str(), std::string(value_of(before.text)).c_str(), 1);
  }
  for (const auto& [name, entry] : now) {
    texts.push_back(fmt::format("environment variable {} became {} (removed again)", name, shown_value(entry)));
    unsetenv(name.c_str());
  }
  tzset();  // updates the TZ of the C library
  shorten(texts);
  return texts;
}

}  // namespace mebots::master
