// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/hexadecimal.hpp"
#include "mebots/modeldesc/model_description.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <type_traits>
#include <variant>

namespace mebots::master {

/// Returns the double with the shortest decimal text of a Float32, so that JSON contains the same digits as
/// results.csv.
inline double shortest_float32(double value) {
  const auto single = static_cast<float>(value);
  std::array<char, 32> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), single);
  double shortest = value;  // stays unchanged for infinity and NaN
  if (std::isfinite(single)) std::from_chars(text.data(), written.ptr, shortest);
  return shortest;
}

/// Converts a value to JSON. A missing value becomes null, and a Binary becomes hexadecimal digits.
inline nlohmann::ordered_json json_of(modeldesc::Type type, const modeldesc::Value& value) {
  if (type == modeldesc::Type::uint64 && std::holds_alternative<std::int64_t>(value))
    return static_cast<std::uint64_t>(std::get<std::int64_t>(value));
  if (type == modeldesc::Type::float32 && std::holds_alternative<double>(value))
    return shortest_float32(std::get<double>(value));
  if (type == modeldesc::Type::binary && std::holds_alternative<std::string>(value))
    return hexadecimal(std::get<std::string>(value));
  return std::visit(
      []<typename T>(const T& held) -> nlohmann::ordered_json {
        if constexpr (std::is_same_v<T, std::monostate>) {
          return nullptr;
        } else {
          return held;
        }
      },
      value);
}

/// Appends a member to an object, or creates the object if `object` is null. The caller must ensure that the key is
/// new, because a search of an ordered object is slow.
inline nlohmann::ordered_json& add_member(nlohmann::ordered_json& object, const std::string& key) {
  if (object.is_null()) object = nlohmann::ordered_json::object();
  auto& members = object.get_ref<nlohmann::ordered_json::object_t&>();
  return members.emplace_back(key, nullptr).second;
}

}  // namespace mebots::master
