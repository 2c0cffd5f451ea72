// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/document.hpp"

#include <nlohmann/json_fwd.hpp>

#include <map>
#include <string>

namespace mebots::data {

/// Creates documents from values of another format, such as SSP. This header is not installed, because it exposes a
/// type of nlohmann-json.
struct JsonDocument {
  /// Maps JSON pointers to places in the file `name`, for messages. A value that is not listed has the place of its
  /// container.
  using Places = std::map<std::string, std::string>;

  /// Creates a document from `value`. All texts must be UTF-8. Numbers that are not finite become null.
  static Document of(const nlohmann::ordered_json& value, std::string name, Places places);
};

}  // namespace mebots::data
