// SPDX-License-Identifier: Apache-2.0
#include "logger.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace mebots::shell {
namespace {

constexpr std::string_view kStandardCategories[] = {"logStatusWarning", "logStatusError", "logStatusFatal", "logAll"};

}  // namespace

Logger::Logger(const fmi2CallbackFunctions& callbacks, std::string instance_name, bool logging_on,
               std::span<const std::string_view> own_categories)
    : callback_(callbacks.logger),
      environment_(callbacks.componentEnvironment),
      instance_name_(std::move(instance_name)) {
  for (const std::string_view name : own_categories) categories_.push_back({std::string(name), logging_on});
  for (const std::string_view name : kStandardCategories) categories_.push_back({std::string(name), logging_on});
}

void Logger::log(fmi2Status status, std::string_view category, std::string_view message) {
  if (callback_ == nullptr) return;
  const bool is_error = status == fmi2Error || status == fmi2Fatal;
  if (!is_error && !is_on(category)) return;
  // The message is a printf format to the tool, without arguments from us.
  std::string format;
  format.reserve(message.size());
  for (const char c : message) format.append(c == '%' ? 2 : 1, c);
  callback_(environment_, instance_name_.c_str(), status, std::string(category).c_str(), format.c_str());
}

bool Logger::is_on(std::string_view category) const {
  return std::ranges::any_of(categories_,
                             [&](const Category& c) { return c.on && (c.name == category || c.name == "logAll"); });
}

void Logger::set_logging(bool on, std::span<const fmi2String> categories) {
  const auto find = [&](std::string_view name) {
    const auto found = std::ranges::find(categories_, name, &Category::name);
    if (found == categories_.end()) {
      std::string known;
      for (const Category& category : categories_) known += (known.empty() ? "" : ", ") + category.name;
      throw Error(fmt::format("unknown log category \"{}\"; known are {}", name, known));
    }
    return found;
  };
  for (const fmi2String name : categories) {
    if (name == nullptr) throw Error("a log category is a null pointer");
    find(name);
  }
  // With a list, "on" means these and no others.
  if (categories.empty() || on)
    for (Category& category : categories_) category.on = on && categories.empty();
  for (const fmi2String name : categories) find(name)->on = on;
}

}  // namespace mebots::shell
