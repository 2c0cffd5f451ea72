// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace mebots::master {

/// States how mebots reverts a change of the process before the next run.
enum class Remedy {
  undone,   ///< mebots restores the previous value, or later runs cannot see the change
  renewed,  ///< renew_c_library() restores the value of a new process
  none,     ///< mebots cannot revert the change
};

/// A function or variable of the C or C++ library that changes process-wide data. Such a change would affect the next
/// run in the same process. docs/master/clean-fmus.md lists all of these functions and variables.
struct ProcessFunction {
  std::string_view symbol;  ///< the symbol's name in ELF files
  std::string_view what;    ///< description of the changed data
  Remedy remedy;
};

std::span<const ProcessFunction> process_functions();

/// Returns the list's entry for this symbol. Returns null if the list does not contain the symbol.
const ProcessFunction* find_process_function(std::string_view symbol);

/// States which parts of ProcessState a library can change by the functions that it imports.
enum class ProcessReach {
  nothing,      ///< the library imports no function that changes data in ProcessState
  descriptors,  ///< the library can close descriptors
  everything,   ///< the library imports a function of the list, or can find one at run time
};

/// Returns which parts of ProcessState a library can change if it imports this symbol.
ProcessReach reach_of(std::string_view symbol);

/// Returns the function's name for messages: without version prefix, and demangled if it is a C++ name.
std::string_view readable_name(const ProcessFunction& function);

/// Restores all data whose remedy is `renewed` to the state of a new process.
void renew_c_library();

}  // namespace mebots::master
