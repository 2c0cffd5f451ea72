// SPDX-License-Identifier: Apache-2.0
#include "logger.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace mebots::shell {
namespace {

constexpr std::string_view kStandardCategories[] = {"logStatusWarning", "logStatusError", "logStatusFatal", "logAll"};

}  // namespace

Logger::Logger(Sink sink, bool logging_on, std::span<const std::string_view> own_categories) : sink_(std::move(sink)) {
  for (const std::string_view name : own_categories) categories_.push_back({std::string(name), logging_on});
  for (const std::string_view name : kStandardCategories) categories_.push_back({std::string(name), logging_on});
}

void Logger::log(Status status, std::string_view category, std::string_view message) {
  if (!sink_) return;
  const bool is_error = status == Status::error || status == Status::fatal;
  if (!is_error && !is_on(category)) return;
  sink_(status, std::string(category).c_str(), message);
}

bool Logger::is_on(std::string_view category) const {
  return std::ranges::any_of(categories_,
                             [&](const Category& c) { return c.on && (c.name == category || c.name == "logAll"); });
}

void Logger::set_logging(bool on, std::span<const char* const> categories) {
  const auto find = [&](std::string_view name) {
    const auto found = std::ranges::find(categories_, name, &Category::name);
    if (found == categories_.end()) {
      std::string known;
      for (const Category& category : categories_) known += (known.empty() ? "" : ", ") + category.name;
      throw Error(fmt::format("unknown log category \"{}\"; known are {}", name, known));
    }
    return found;
  };
  for (const char* const name : categories) {
    if (name == nullptr) throw Error("a log category is a null pointer");
    find(name);
  }
  // If `on` is true, enables the listed categories and disables all others. If `on` is false, disables the listed
  // categories. An empty list means all categories.
  if (categories.empty() || on)
    for (Category& category : categories_) category.on = on && categories.empty();
  for (const char* const name : categories) find(name)->on = on;
}

std::string doubled(std::string_view text, char mark) {
  std::string result;
  result.reserve(text.size());
  for (const char c : text) result.append(c == mark ? 2 : 1, c);
  return result;
}

}  // namespace mebots::shell
