// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/error.hpp"
#include "mebots/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

/// Reading the data files that stand beside a model: JSON in which every quantity is an object
/// {"value", "unit", "source"}. Whatever is wrong becomes an Error that names file, key, value and limit.
namespace mebots::data {

using mebots::text_of;

/// What a number may be. The default allows every finite number.
struct Limits {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool min_is_allowed = true;

  static Limits positive() { return {0, std::numeric_limits<double>::infinity(), false}; }
  static Limits at_least(double least) { return {least, std::numeric_limits<double>::infinity(), true}; }
  static Limits between(double least, double most) { return {least, most, true}; }

  bool admit(double value) const {
    return std::isfinite(value) && value <= max && (min_is_allowed ? value >= min : value > min);
  }
  std::string text() const {
    const std::string lower = fmt::format("{} {}", min_is_allowed ? ">=" : ">", min);
    if (std::isinf(max)) return std::isinf(min) ? "finite" : lower;
    return fmt::format("{} and <= {}", lower, max);
  }
};

/// One object inside a data file. Lives no longer than its File.
class Node {
 public:
  Node(const std::string& file, std::string path, const nlohmann::json& json)
      : file_(&file), path_(std::move(path)), json_(&json) {}

  /// Throws for every key that is not listed: most often a typing error that would otherwise be ignored.
  const Node& only(std::initializer_list<std::string_view> keys) const {
    for (const auto& item : json_->items()) {
      if (std::find(keys.begin(), keys.end(), item.key()) != keys.end()) continue;
      fail(item.key(), fmt::format("is not a key of this object; known here: {}", fmt::join(keys, ", ")));
    }
    return *this;
  }

  bool has(std::string_view key) const { return json_->contains(key); }
  /// File and key, as errors name it.
  std::string name() const { return path_.empty() ? *file_ : fmt::format("{}: {}", *file_, path_); }

  /// Keys in the order of the alphabet.
  std::vector<std::string> keys() const {
    std::vector<std::string> found;
    for (const auto& item : json_->items()) found.push_back(item.key());
    return found;
  }

  Node object(std::string_view key) const {
    const auto& json = get(key);
    if (!json.is_object()) fail(key, fmt::format("= {} must be an object", shown(json)));
    return {*file_, name_of(key), json};
  }

  /// A list of objects.
  std::vector<Node> objects(std::string_view key) const {
    const auto& json = get(key);
    if (!json.is_array()) fail(key, fmt::format("= {} must be a list of objects", shown(json)));
    std::vector<Node> found;
    for (std::size_t i = 0; i < json.size(); ++i) {
      const std::string item = fmt::format("{}[{}]", key, i);
      if (!json[i].is_object()) fail(item, fmt::format("= {} must be an object", shown(json[i])));
      found.emplace_back(*file_, name_of(item), json[i]);
    }
    return found;
  }

  std::string text(std::string_view key) const {
    const auto& json = get(key);
    if (!json.is_string()) fail(key, fmt::format("= {} must be a text", shown(json)));
    return json.get<std::string>();
  }

  bool flag(std::string_view key) const {
    const auto& json = get(key);
    if (!json.is_boolean()) fail(key, fmt::format("= {} must be true or false", shown(json)));
    return json.get<bool>();
  }

  double number(std::string_view key, const Limits& limits = {}) const { return checked(key, get(key), limits); }

  std::vector<double> numbers(std::string_view key, const Limits& limits = {}) const {
    const auto& json = get(key);
    if (!json.is_array() || json.empty()) fail(key, fmt::format("= {} must be a list of numbers", shown(json)));
    std::vector<double> values;
    for (std::size_t i = 0; i < json.size(); ++i) {
      values.push_back(checked(fmt::format("{}[{}]", key, i), json[i], limits));
    }
    return values;
  }

  /// A list of numbers, each greater than the one before.
  std::vector<double> rising_numbers(std::string_view key, const Limits& limits = {}) const {
    auto values = numbers(key, limits);
    for (std::size_t i = 1; i < values.size(); ++i) {
      if (values[i] > values[i - 1]) continue;
      fail(fmt::format("{}[{}]", key, i),
           fmt::format("= {} must be greater than the value before it, {}", values[i], values[i - 1]));
    }
    return values;
  }

  /// The value of {"value": number, "unit": text, "source": text}; the unit must be the one asked for.
  double quantity(std::string_view key, std::string_view unit, const Limits& limits = {}) const {
    const Node quantity = object(key);
    quantity.only({"value", "unit", "source"});
    quantity.require_unit(unit);
    if (quantity.text("source").empty()) quantity.fail("source", "is empty: say where the value comes from");
    return quantity.number("value", limits);
  }

  void require_unit(std::string_view unit) const {
    const std::string found = text("unit");
    if (found != unit) fail("unit", fmt::format("= \"{}\" must be \"{}\"", found, unit));
  }

  [[noreturn]] void fail(std::string_view key, std::string_view problem) const {
    throw Error(fmt::format("{}: {} {}", *file_, name_of(key), problem));
  }

 private:
  std::string name_of(std::string_view key) const {
    return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
  }

  static std::string shown(const nlohmann::json& json) {
    if (json.is_structured()) return json.type_name();  // may be deeper than dump can go
    std::string text = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    if (text.size() > 40) text = text.substr(0, 40) + "...";
    return text;
  }

  const nlohmann::json& get(std::string_view key) const {
    const auto found = json_->find(key);
    if (found == json_->end()) fail(key, "is missing");
    return *found;
  }

  double checked(std::string_view key, const nlohmann::json& json, const Limits& limits) const {
    if (!json.is_number()) fail(key, fmt::format("= {} must be a number", shown(json)));
    const auto value = json.get<double>();
    if (!limits.admit(value)) fail(key, fmt::format("= {} must be {}", value, limits.text()));
    return value;
  }

  const std::string* file_;
  std::string path_;
  const nlohmann::json* json_;
};

/// Told of every step of the parser; throws when an object has the same key twice, where the last one would win unseen,
/// and when brackets stand in brackets so often that the functions that walk down into them need too much stack.
class CarefulParsing {
 public:
  explicit CarefulParsing(std::string file) : file_(std::move(file)) {}

  template <typename Json>
  bool operator()(int depth, nlohmann::json::parse_event_t event, Json& parsed) {
    using Event = nlohmann::json::parse_event_t;
    constexpr int kDeepest = 100;
    if (depth > kDeepest) throw Error(fmt::format("{}: is nested deeper than {} levels", file_, kDeepest));
    const auto level = static_cast<std::size_t>(depth);
    if (event == Event::object_start) {
      if (keys_.size() <= level + 1) keys_.resize(level + 2);
      keys_[level + 1].clear();
    } else if (event == Event::key) {
      const auto key = parsed.template get<std::string>();
      if (std::find(keys_[level].begin(), keys_[level].end(), key) != keys_[level].end()) {
        throw Error(fmt::format("{}: {} stands twice in the same object", file_, key));
      }
      keys_[level].push_back(key);
    }
    return true;
  }

 private:
  std::string file_;
  std::vector<std::vector<std::string>> keys_;  // by depth
};

/// A parsed data file; its root is an object.
class File {
 public:
  explicit File(const std::filesystem::path& path) : File(text_of(path), path.string()) {}
  /// `name` stands in errors.
  File(std::string_view text, std::string name) : name_(std::move(name)) {
    try {
      json_ = nlohmann::json::parse(text, CarefulParsing(name_));
    } catch (const nlohmann::json::parse_error& error) {
      throw Error(fmt::format("{}: is not JSON: {}", name_, error.what()));
    } catch (const nlohmann::json::out_of_range& error) {
      throw Error(fmt::format("{}: a number is too large: {}", name_, error.what()));
    }
    if (!json_.is_object()) throw Error(fmt::format("{}: must hold a JSON object", name_));
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  Node root() const { return {name_, "", json_}; }

 private:
  std::string name_;
  nlohmann::json json_;
};

/// The file that a String parameter means: a name in `folder` (without .json), or a path, which is whatever
/// holds a slash or ends in .json. `variable` names the parameter in the Error when there is no such file.
inline std::filesystem::path find_file(const std::filesystem::path& folder, std::string_view name,
                                       std::string_view variable) {
  const bool is_path = name.find('/') != std::string_view::npos || name.ends_with(".json");
  auto path = is_path ? std::filesystem::path(name) : folder / fmt::format("{}.json", name);
  std::error_code ignored;
  if (!name.empty() && std::filesystem::is_regular_file(path, ignored)) return path;
  if (is_path) throw Error(fmt::format("{} = \"{}\": there is no such file", variable, name));
  std::vector<std::string> known;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    if (entry.path().extension() == ".json") known.push_back(entry.path().stem().string());
  }
  std::sort(known.begin(), known.end());
  throw Error(fmt::format("{} = \"{}\": unknown name; take one of {}, or the path of a .json file", variable, name,
                          fmt::join(known, ", ")));
}

}  // namespace mebots::data
