// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace mebots::master {

/// Runs the program `mebots-fmu-host`: one FMU on behalf of the master that started the program, until the master
/// closes it. `words`: the program, the master's process number, the memory limit in bytes. For a sandbox also
/// `--sandbox FOLDER`, `--reads PATH` for each further readable place, `--may-lack MECHANISM` for each mechanism that
/// may be absent, and `--inside` once the namespaces have been entered. Returns the exit code.
int run_fmu_host(int argument_count, char** words);

}  // namespace mebots::master
