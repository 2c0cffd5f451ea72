// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace mebots::master {

/// How a change of the process is set back before its next run.
enum class Remedy {
  undone,   ///< mebots compares the process with the one before and puts it right, or no later run can see it
  renewed,  ///< renew_c_library() sets it as in a process that has just started
  none,     ///< mebots cannot set it back
};

/// A function or variable of the C or C++ library by which an FMU changes more than its own memory: what one run leaves
/// there, the next run in the same process finds. docs/master/clean-fmus.md lists them all.
struct ProcessFunction {
  std::string_view symbol;  ///< as an ELF file names it
  std::string_view what;    ///< what it changes
  Remedy remedy;
};

std::span<const ProcessFunction> process_functions();

/// Returns null for a symbol that is not in the list.
const ProcessFunction* find_process_function(std::string_view symbol);

/// How much of ProcessState a library can change, as its imports show.
enum class ProcessReach {
  nothing,      ///< it imports none of the functions that change what ProcessState compares
  descriptors,  ///< it can close descriptors
  everything,   ///< it imports a function of the list, or can find one at run time
};

/// Returns the reach that importing this symbol gives.
ProcessReach reach_of(std::string_view symbol);

/// A name for people: without a version's prefix, C++ names without their mangling.
std::string_view readable_name(const ProcessFunction& function);

/// Sets all that is `renewed` as in a process that has just started.
void renew_c_library();

}  // namespace mebots::master
