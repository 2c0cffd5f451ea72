// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/message.hpp"

namespace mebots::master {

/// Takes what FMUs and the run say.
class MessageSink {
 public:
  virtual ~MessageSink() = default;
  virtual void message(const Message& message) = 0;
};

}  // namespace mebots::master
