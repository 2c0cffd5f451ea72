// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace mebots::master {

/// What the program `mebots-fmu-host` does: runs one FMU on behalf of the master that started it, until that
/// closes it. `arguments`: the master's process number, the memory limit in bytes and, for a sandbox, the
/// only folder that it may write into. Returns the exit code.
int run_fmu_host(int argument_count, char** arguments);

}  // namespace mebots::master
