// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace mebots {

enum class Severity { info, warning, error };

/// Something that an FMU, or the run itself, has to say. The texts live only during the call that hands it over.
struct Message {
  std::string_view instance;  ///< empty: said by the run itself
  Severity severity = Severity::info;
  std::string_view category;  ///< the FMU's log category; "notice" of the run
  std::string_view text;
  std::int64_t time_ns = 0;  ///< start of the step in which it was said, or the communication point between two steps
};

}  // namespace mebots
