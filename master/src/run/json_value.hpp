// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"

#include <nlohmann/json.hpp>

#include <string>
#include <type_traits>
#include <variant>

namespace mebots::master {

/// A variable's value as JSON has it; null for none.
inline nlohmann::ordered_json json_of(const modeldesc::Value& value) {
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

/// A new member of an object, or of what is none yet. The key must not be there: an ordered object would look through
/// all that it has.
inline nlohmann::ordered_json& add_member(nlohmann::ordered_json& object, const std::string& key) {
  if (object.is_null()) object = nlohmann::ordered_json::object();
  auto& members = object.get_ref<nlohmann::ordered_json::object_t&>();
  return members.emplace_back(key, nullptr).second;
}

}  // namespace mebots::master
