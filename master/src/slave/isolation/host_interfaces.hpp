// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slave/clocked/event_instance.hpp"
#include "solver/clock_instance.hpp"
#include "solver/continuous_instance.hpp"

#include "protocol.hpp"

namespace mebots::master::isolation {

/// Executes a call to an instance that a solver of the master integrates, and writes the answer. Returns false if the
/// call does not belong to this interface.
bool dispatch(ContinuousInstance& instance, Call call, SharedReader& commands, SharedWriter& answers);

/// Executes a call to an instance whose events the master handles, and writes the answer. Returns false if the call
/// does not belong to this interface.
bool dispatch(EventInstance& instance, Call call, SharedReader& commands, SharedWriter& answers);

/// Executes a call to the clocks of an instance, and writes the answer. Returns false if the call does not belong to
/// this interface.
bool dispatch(ClockInstance& instance, Call call, SharedReader& commands, SharedWriter& answers);

}  // namespace mebots::master::isolation
