// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace mebots::master::isolation {

/// Allows this process the system calls of a simulation; every other one fails with EPERM. With namespaces, it may use
/// sockets and change attributes of files, all of which are private to it then. Calls in the form of another
/// architecture end the process. Returns nothing, or why the system allows no filter.
std::optional<std::string> allow_simulation_calls(bool has_namespaces);

}  // namespace mebots::master::isolation
