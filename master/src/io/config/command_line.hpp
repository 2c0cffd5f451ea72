// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/system_description.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace mebots::master {

/// Parses `--set INSTANCE.VARIABLE=VALUE`. The value has no type until the FMU is opened. Throws InputError if the text
/// does not have this form.
Setting read_set(const std::string& text);

/// Moves the split between name and value to a later `=` if is_known() is true for the longer name, because names may
/// contain `=`. Uses the longest known name. If no longer name is known, returns the setting unchanged.
Setting with_longest_name(const Setting& setting, const std::function<bool(const std::string&)>& is_known);

/// Inserts `--set` before each further assignment: `--set a.b=1 c.d=2` becomes `--set a.b=1 --set c.d=2`. An assignment
/// is a token with `=` that follows `--set` and precedes the next option.
std::vector<std::string> with_each_set(const std::vector<std::string>& arguments);

/// Parses a positive time in seconds or as a ratio such as 1/60, and rounds it to nanoseconds. Throws InputError with
/// the name of the option.
std::int64_t read_duration(const std::string& option, const std::string& text);
/// Parses a time in seconds or as a ratio, and rounds it to nanoseconds. Throws InputError with the name of the option.
std::int64_t read_time(const std::string& option, const std::string& text);
/// Parses a positive time in seconds or as a ratio, and keeps its form. Throws InputError with the name of the option.
WrittenTime read_step(const std::string& option, const std::string& text);

}  // namespace mebots::master
