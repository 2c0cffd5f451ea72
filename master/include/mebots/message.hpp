// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace mebots {

enum class Severity { info, warning, error };

/// A message of an FMU or of the run itself. Its texts are valid only during the call that delivers the message.
struct Message {
  std::string_view instance;  ///< empty: a message of the run itself
  Severity severity = Severity::info;
  std::string_view category;  ///< the FMU's log category; for the run "notice"
  std::string_view text;
  std::int64_t time_ns = 0;  ///< start of the step that logged it, or the communication point between two steps
};

}  // namespace mebots
