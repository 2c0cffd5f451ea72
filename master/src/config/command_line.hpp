// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "config/system_description.hpp"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace mebots::master {

/// Applies INSTANCE.VARIABLE=VALUE to a system; the value's type is checked once the FMU is open.
/// Throws InputError for a text of another form or an unknown instance.
void apply_set(SystemDescription& system, const std::string& text);

/// Appends the overrides of a scenario file. Returns what to note among the changes: its name and hash. Throws
/// InputError.
std::string apply_scenario(SystemDescription& system, const std::filesystem::path& file);

/// A time greater than 0, as typed in seconds, in nanoseconds. Throws InputError that names the option.
std::int64_t read_duration(const std::string& option, const std::string& text);

/// Applies `--stop-time`. Throws InputError unless it is a number of seconds that fits the steps.
void apply_stop_time(SystemDescription& system, const std::string& text);

}  // namespace mebots::master
