// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/master/message.hpp"
#include "mebots/master/resolved_system.hpp"
#include "mebots/master/slave.hpp"
#include "mebots/master/slave_options.hpp"

#include <memory>
#include <vector>

namespace mebots::master {

/// Instantiates the slaves of a system, in the order of the config, each where and with what the config asks for.
/// Throws SlaveError when an FMU gives no instance.
std::vector<std::unique_ptr<Slave>> make_slaves(const ResolvedSystem& system, MessageSink& messages,
                                                const SlaveOptions& options);

}  // namespace mebots::master
