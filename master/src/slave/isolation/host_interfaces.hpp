// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slave/clocked/event_instance.hpp"
#include "solver/clock_instance.hpp"
#include "solver/continuous_instance.hpp"

#include "protocol.hpp"

namespace mebots::master::isolation {

/// Executes a call of ContinuousInstance and writes the answer. Returns false if `call` belongs to another interface.
bool dispatch(ContinuousInstance& instance, Call call, SharedReader& commands, SharedWriter& answers);

/// Executes a call of EventInstance and writes the answer. Returns false if `call` belongs to another interface.
bool dispatch(EventInstance& instance, Call call, SharedReader& commands, SharedWriter& answers);

/// Executes a call of ClockInstance and writes the answer. Returns false if `call` belongs to another interface.
bool dispatch(ClockInstance& instance, Call call, SharedReader& commands, SharedWriter& answers);

}  // namespace mebots::master::isolation
