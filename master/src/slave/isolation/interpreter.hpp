// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

namespace mebots::master {

/// Reads the FMU's ELF files. The Python is that of MEBOTS_PYTHON, else `python3` on PATH, else any in the system's
/// folders. If no Python is found, `library` stays empty.
Interpreter interpreter_of(const Fmu& fmu);

}  // namespace mebots::master
