// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

namespace mebots::master {

class Fmu;

/// The decision about an FMU that is to share this process.
struct Admission {
  bool loaded = false;
  bool certain = false;  ///< the FMU or another would compute with a library or a variable that is not its own
  std::string reason;    ///< completes "b.fmu runs in its own process: "
};

enum class Risk { refuse, accept };

/// Loads an FMU's library into this process, unless its ELF files show that the FMU could not keep apart from the
/// program or from other FMUs there. The answer depends on what the process has loaded. With Risk::accept, an FMU is
/// loaded in spite of a reason that is not certain. Throws InputError if the library cannot be loaded at all.
/// From any thread.
Admission load_into_this_process(const std::shared_ptr<Fmu>& fmu, Risk risk);

}  // namespace mebots::master
