// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace mebots::master {

enum class Severity { info, warning, error };

/// Something that an FMU told its importing tool. The texts live only during the call.
struct Message {
  std::string_view instance;
  Severity severity = Severity::info;
  std::string_view category;
  std::string_view text;
  std::int64_t time_ns = 0;  ///< start of the step in which it was said, or the communication point between two steps
};

/// Takes what FMUs say.
class MessageSink {
 public:
  virtual ~MessageSink() = default;
  virtual void message(const Message& message) = 0;
};

}  // namespace mebots::master
