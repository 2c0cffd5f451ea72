// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/master/system_description.hpp"

#include <span>
#include <string>

namespace mebots::master {

/// Applies INSTANCE.VARIABLE=VALUE to a system; the value's type is checked once the FMU is open.
/// Throws InputError for a text of another form or an unknown instance.
void apply_set(SystemDescription& system, const std::string& text);

/// Applies `--stop-time`. Throws InputError unless it is a number of seconds that fits the steps.
void apply_stop_time(SystemDescription& system, const std::string& text);

}  // namespace mebots::master
