// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/system_description.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

/// Parses texts of the command line.
namespace mebots::master {

/// Parses `--set INSTANCE.VARIABLE=VALUE`. The FMU determines the type of the value later. Throws InputError if the
/// text does not have this form.
Setting read_set(const std::string& text);

/// Splits the setting again, at the `=` after the longest known name, because names of variables may contain `=`. If no
/// longer name is known, returns the setting unchanged.
Setting with_longest_name(const Setting& setting, const std::function<bool(const std::string&)>& is_known);

/// Inserts `--set` before each further assignment: `--set a.b=1 c.d=2` becomes `--set a.b=1 --set c.d=2`. After `--set`
/// and its assignment, every token that contains `=` is an assignment, up to the next option.
std::vector<std::string> with_each_set(const std::vector<std::string>& arguments);

/// Parses a time greater than 0, in seconds or as a ratio such as 1/60. Returns it rounded to nanoseconds. Throws
/// InputError that names the option if the text is no such time.
std::int64_t read_duration(const std::string& option, const std::string& text);
/// Parses a time in seconds or as a ratio. Returns it rounded to nanoseconds. Throws InputError that names the option.
std::int64_t read_time(const std::string& option, const std::string& text);
/// Parses a time greater than 0, and keeps the form in which it was typed: seconds or ratio. Throws InputError that
/// names the option if the text is no such time.
WrittenTime read_step(const std::string& option, const std::string& text);

}  // namespace mebots::master
