// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reading.hpp"

namespace mebots::master::config {

/// The variable and the one comparison of a condition.
ConditionDescription read_condition(Object& object, const SystemDescription& system);

/// A condition that may have to last: `for`.
ConditionDescription read_lasting_condition(const Node& node, const SystemDescription& system);

}  // namespace mebots::master::config
