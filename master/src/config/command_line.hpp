// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/system_description.hpp"

#include <cstdint>
#include <string>

/// What people type as options, read into what runs are made of.
namespace mebots::master {

/// `--set INSTANCE.VARIABLE=VALUE`. The value's type is found out when the FMU is known. Throws InputError for a text
/// of another form.
Setting read_set(const std::string& text);

/// A time greater than 0, as typed in seconds, in nanoseconds. Throws InputError that names the option.
std::int64_t read_duration(const std::string& option, const std::string& text);

}  // namespace mebots::master
