// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "run/run.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace mebots::app {

/// What is shown of a run that is over: outcome, speed, the summary's values with their units, where the files are.
std::vector<std::string> end_lines(const master::Run& run);

/// Throws InputError when a run of this system cannot end with one of the outcomes that are expected.
void check_expected(const master::SystemDescription& system, const std::vector<std::string>& expected);

/// Why the outcome of a run that is over is not as wanted: one of `expected`, any when there are none. Empty when it
/// is.
std::string why_unexpected(const master::Run& run, const std::vector<std::string>& expected);

/// A text as one word of a POSIX shell, quoted where it must be.
std::string shell_word(std::string_view text);

}  // namespace mebots::app
