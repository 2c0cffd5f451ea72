// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace mebots::master {

/// How mebots reverts a process-wide change before the next run.
enum class Remedy {
  undone,   ///< restores the previous value, or the change does not affect later runs
  renewed,  ///< restores the value of a new process with renew_c_library()
  none,     ///< cannot revert the change
};

/// A function or variable of the C or C++ library that changes process-wide data and thus the next run in the process.
/// docs/master/clean-fmus.md lists them.
struct ProcessFunction {
  std::string_view symbol;  ///< name in ELF files
  std::string_view what;    ///< the changed data
  Remedy remedy;
};

std::span<const ProcessFunction> process_functions();

/// Returns the entry of a symbol; null if process_functions() does not contain the symbol.
const ProcessFunction* find_process_function(std::string_view symbol);

/// The parts of ProcessState that a library can change by its imported functions.
enum class ProcessReach {
  nothing,      ///< the library imports no function that changes data in ProcessState
  descriptors,  ///< the library can close file descriptors
  everything,   ///< the library imports a function from process_functions(), or can find one at run time
};

/// Returns the parts of ProcessState that a library with this import can change.
ProcessReach reach_of(std::string_view symbol);

/// Returns the demangled name of a function without its version prefix, for messages.
std::string_view readable_name(const ProcessFunction& function);

/// Resets the data of all functions with Remedy::renewed, such as the state of rand(), to the values in a new process.
void renew_c_library();

}  // namespace mebots::master
