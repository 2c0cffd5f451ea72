// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/run_options.hpp"
#include "model/system_description.hpp"
#include "resolve/resolve.hpp"

#include <string>
#include <vector>

/// The names of variables in settings: of one variable, or a pattern (* and ?) of several.
namespace mebots::master {

/// Returns the variable of this name. If no variable has it, returns the variables that match the name as a pattern, in
/// the order of instances and descriptions. Opens the FMUs.
std::vector<std::string> matching_variables(const SystemDescription& system, FmuLibrary& library,
                                            const std::string& name);

/// A setting of one variable after the check of its value.
struct CheckedSetting {
  LocatedSetting located;
  std::string text;      ///< of the change, for the summary
  bool is_size = false;  ///< true for a structural parameter, which can change the sizes of arrays
};

/// Returns a checked setting for each variable that matches the setting's name. Opens the FMUs. Throws InputError with
/// the nearest names if no variable matches, and for a value that a variable does not accept.
std::vector<CheckedSetting> checked_settings(SystemDescription& system, FmuLibrary& library, const Setting& setting);

}  // namespace mebots::master
