// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

namespace mebots::modeldesc {

/// Keeps the order of the file: value references follow it.
using Json = nlohmann::ordered_json;

/// Reads a JSON file; throws mebots::Error with file, line and column.
Json read_json(const std::filesystem::path& file);

/// A JSON object whose errors say where it stands: `where` is "fmu_x/description.json, variable cell.voltage".
class JsonObject {
 public:
  JsonObject(const Json& json, std::string where);

  /// Throws when there is a key that is not among these.
  void allow_only(std::initializer_list<std::string_view> keys) const;

  bool has(std::string_view key) const { return json_->contains(key); }
  const Json& at(std::string_view key) const;
  std::string text(std::string_view key) const;
  std::string text_or(std::string_view key, std::string fallback) const;
  double number(std::string_view key) const;
  std::optional<double> optional_number(std::string_view key) const;
  bool flag(std::string_view key) const;  // false when missing
  const Json& list(std::string_view key) const;
  const Json& json() const { return *json_; }
  const std::string& where() const { return where_; }

  [[noreturn]] void fail(std::string_view what) const;

 private:
  const Json* json_;
  std::string where_;
};

}  // namespace mebots::modeldesc
