// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/document.hpp"

#include <nlohmann/json_fwd.hpp>

#include <map>
#include <string>

namespace mebots::data {

/// Makes documents of values that were put together from another format, such as an SSP. Not installed, because it
/// shows a type of nlohmann-json.
struct JsonDocument {
  /// By JSON pointer: the place of a value in `name`, for messages. A value that is not listed has the place of the
  /// object or list around it.
  using Places = std::map<std::string, std::string>;

  /// All texts must be UTF-8. A number that is not finite becomes null.
  static Document of(const nlohmann::ordered_json& value, std::string name, Places places);
};

}  // namespace mebots::data
