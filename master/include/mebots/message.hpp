// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace mebots {

enum class Severity { info, warning, error };

/// A message of an FMU or of the run itself. Its texts are valid only during the call that delivers the message.
struct Message {
  std::string_view instance;  ///< name of the instance; empty if the run itself issued the message
  Severity severity = Severity::info;
  std::string_view category;  ///< log category of the FMU; "notice" if the run itself issued the message
  std::string_view text;
  /// Start of the step during which the message was logged, or the communication point between two steps.
  std::int64_t time_ns = 0;
};

}  // namespace mebots
