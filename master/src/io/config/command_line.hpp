// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/system_description.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

/// What people type as options, read into what runs are made of.
namespace mebots::master {

/// `--set INSTANCE.VARIABLE=VALUE`. The value's type is found out when the FMU is known. Throws InputError for a text
/// of another form.
Setting read_set(const std::string& text);

/// The setting with its name ending at the `=` after the longest known name: names of variables may contain `=`. A
/// setting whose name is known in no longer form stays as it is.
Setting with_longest_name(const Setting& setting, const std::function<bool(const std::string&)>& is_known);

/// The arguments with `--set` in front of each further assignment, so that `--set a.b=1 c.d=2` becomes
/// `--set a.b=1 --set c.d=2`. Each token with `=` that follows an assignment is one, up to the next option.
std::vector<std::string> with_each_set(const std::vector<std::string>& arguments);

/// A time greater than 0, as typed in seconds or as a ratio such as 1/60, rounded to nanoseconds. Throws InputError
/// that names the option.
std::int64_t read_duration(const std::string& option, const std::string& text);
/// A time in seconds or as a ratio, rounded to nanoseconds. Throws InputError that names the option.
std::int64_t read_time(const std::string& option, const std::string& text);
/// A time greater than 0 as it was typed: a number of seconds or a ratio. Throws InputError that names the option.
WrittenTime read_step(const std::string& option, const std::string& text);

}  // namespace mebots::master
