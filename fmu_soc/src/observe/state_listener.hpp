// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clock.hpp"

namespace mebots::soc {

/// Who hears when something about a chip may have changed that is not an instruction. A device was touched or has gone
/// on, the core fell asleep, woke or ended, or the caller's span of time is over. Times never go back.
class StateListener {
 public:
  StateListener() = default;
  StateListener(const StateListener&) = delete;
  StateListener& operator=(const StateListener&) = delete;
  virtual ~StateListener() = default;
  virtual void changed(Picoseconds time) = 0;
};

}  // namespace mebots::soc
