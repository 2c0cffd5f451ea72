// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace mebots::master {

/// True if `text` is a pattern, which contains `*` or `?`.
inline bool is_pattern(std::string_view text) {
  return text.find_first_of("*?") != std::string_view::npos;
}

}  // namespace mebots::master
