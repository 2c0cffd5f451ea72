// SPDX-License-Identifier: Apache-2.0
#include "json_object.hpp"

#include "mebots/data_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace mebots::modeldesc {

Json read_json(const std::filesystem::path& file) {
  const auto text = text_of(file);
  try {
    return Json::parse(text, data::CarefulParsing(file.string()));
  } catch (const Json::parse_error& error) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    const auto line = 1 + std::count(text.begin(), end, '\n');
    throw Error(fmt::format("{}, line {}: not JSON: {}", file.string(), line, error.what()));
  }
}

JsonObject::JsonObject(const Json& json, std::string where) : json_(&json), where_(std::move(where)) {
  if (!json.is_object()) fail(fmt::format("an object {{...}} is expected, not {}", json.dump()));
}

void JsonObject::allow_only(std::initializer_list<std::string_view> keys) const {
  for (const auto& item : json_->items()) {
    if (std::ranges::find(keys, item.key()) == keys.end())
      fail(fmt::format("unknown key \"{}\"; known are {}", item.key(), fmt::join(keys, ", ")));
  }
}

const Json& JsonObject::at(std::string_view key) const {
  const auto found = json_->find(key);
  if (found == json_->end()) fail(fmt::format("the key \"{}\" is missing", key));
  return *found;
}

std::string JsonObject::text(std::string_view key) const {
  const Json& value = at(key);
  if (!value.is_string()) fail(fmt::format("\"{}\" must be a text, not {}", key, value.dump()));
  return value.get<std::string>();
}

std::string JsonObject::text_or(std::string_view key, std::string fallback) const {
  return has(key) ? text(key) : std::move(fallback);
}

double JsonObject::number(std::string_view key) const {
  const Json& value = at(key);
  if (!value.is_number()) fail(fmt::format("\"{}\" must be a number, not {}", key, value.dump()));
  return value.get<double>();
}

std::optional<double> JsonObject::optional_number(std::string_view key) const {
  if (!has(key)) return std::nullopt;
  return number(key);
}

bool JsonObject::flag(std::string_view key) const {
  if (!has(key)) return false;
  const Json& value = at(key);
  if (!value.is_boolean()) fail(fmt::format("\"{}\" must be true or false, not {}", key, value.dump()));
  return value.get<bool>();
}

const Json& JsonObject::list(std::string_view key) const {
  const Json& value = at(key);
  if (!value.is_array()) fail(fmt::format("\"{}\" must be a list [...], not {}", key, value.dump()));
  return value;
}

void JsonObject::fail(std::string_view what) const {
  throw Error(fmt::format("{}: {}", where_, what));
}

}  // namespace mebots::modeldesc
