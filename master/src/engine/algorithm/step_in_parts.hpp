// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slave/slave.hpp"

#include <atomic>
#include <cstdint>

namespace mebots::master {

/// A step that the slave may take in parts. When it discards one, it goes back to where it was and tries as much
/// as it said it can, else half as much. Not done when even a part of one microsecond is discarded, or when the
/// slave wants the simulation to end. The slave must be able to save its state. Throws what the slave throws.
StepResult step_in_parts(Slave& slave, std::int64_t start_ns, std::int64_t duration_ns,
                         const std::atomic<bool>& cancel);

}  // namespace mebots::master
