// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/json_node.hpp"
#include "config/system_description.hpp"

namespace mebots::master::config {

/// Reads `variable` and exactly one of `equals`, `above` and `below`; the caller checks for other keys.
ConditionDescription read_condition(const JsonNode& node, const SystemDescription& system);

}  // namespace mebots::master::config
