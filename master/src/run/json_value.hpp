// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/modeldesc/model_description.hpp"

#include <nlohmann/json.hpp>

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

}  // namespace mebots::master
