// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace mebots::master {

class Fmu;

/// Preparations of the host process for an FMU that embeds an interpreter.
struct Interpreter {
  bool embedded = false;    ///< the FMU's library stays loaded: interpreters cannot be unloaded safely
  std::string library;      ///< Python's, if the FMU uses its symbols and names no library that has them; else empty
  std::string python_path;  ///< added to PYTHONPATH: the packages of the virtual environment
};

/// Reads the FMU's ELF files. The Python is that of MEBOTS_PYTHON, else `python3` on PATH, else any in the system's
/// folders. If no Python is found, `library` stays empty.
Interpreter interpreter_of(const Fmu& fmu);

}  // namespace mebots::master
