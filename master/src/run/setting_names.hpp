// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/run_options.hpp"
#include "model/system_description.hpp"
#include "resolve/resolve.hpp"

#include <string>
#include <vector>

/// Finds the variables that a setting names: one variable, or all that match a pattern (* and ?).
namespace mebots::master {

/// Returns `name` if it is the name of a variable. Otherwise, returns all variables that match `name` as a pattern, in
/// the order of the instances in the config and of the variables in modelDescription.xml. Opens the FMUs.
std::vector<std::string> matching_variables(const SystemDescription& system, FmuLibrary& library,
                                            const std::string& name);

/// A setting of one variable with a valid value.
struct CheckedSetting {
  LocatedSetting located;
  std::string text;      ///< describes the change in the summary
  bool is_size = false;  ///< true for a structural parameter, which may change sizes of arrays
};

/// Returns a setting for each variable that matches the setting's name. Opens the FMUs. Throws InputError if no
/// variable matches, with the nearest names, or if a variable does not accept the value.
std::vector<CheckedSetting> checked_settings(SystemDescription& system, FmuLibrary& library, const Setting& setting);

}  // namespace mebots::master
