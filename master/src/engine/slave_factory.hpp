// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "message/message_hub.hpp"
#include "model/resolved_system.hpp"
#include "slave/slave.hpp"
#include "slave/slave_options.hpp"

#include <memory>
#include <vector>

namespace mebots::master {

/// Instantiates the slaves of a system, in the order of the config, each where and with what the config asks for.
/// Throws SlaveError when an FMU gives no instance.
std::vector<std::unique_ptr<Slave>> make_slaves(const ResolvedSystem& system, MessageSink& messages,
                                                const SlaveOptions& options);

}  // namespace mebots::master
