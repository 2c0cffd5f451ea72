// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/run_state.hpp"

#include <string>

namespace mebots::master {

/// How a run ended.
struct End {
  EndReason reason = EndReason::stop_time;
  std::string text;  ///< one sentence for people
};

}  // namespace mebots::master
