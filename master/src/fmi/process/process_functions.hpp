// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace mebots::master {

/// How mebots reverts a change of the process before the next run.
enum class Remedy {
  undone,   ///< mebots restores the previous value, or later runs cannot see the change
  renewed,  ///< renew_c_library() restores the value of a new process
  none,     ///< mebots cannot revert it
};

/// A function or variable of the C or C++ library that changes process-wide data. Such a change would affect the next
/// run in the same process. docs/master/clean-fmus.md lists all of them.
struct ProcessFunction {
  std::string_view symbol;  ///< as an ELF file names it
  std::string_view what;    ///< what it changes
  Remedy remedy;
};

std::span<const ProcessFunction> process_functions();

/// Returns null for a symbol that is not in the list.
const ProcessFunction* find_process_function(std::string_view symbol);

/// The parts of ProcessState that a library can change with the functions that it imports.
enum class ProcessReach {
  nothing,      ///< it imports no function that changes what ProcessState compares
  descriptors,  ///< it can close descriptors
  everything,   ///< it imports a function of the list, or can find one at run time
};

/// Returns which parts of ProcessState a library can change if it imports this symbol.
ProcessReach reach_of(std::string_view symbol);

/// Returns a readable name: without version prefix, C++ names demangled.
std::string_view readable_name(const ProcessFunction& function);

/// Restores everything marked `renewed` to the state of a new process.
void renew_c_library();

}  // namespace mebots::master
