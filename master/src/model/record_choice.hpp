// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

#include <string_view>
#include <vector>

namespace mebots::master {

/// The variables that a system records in every row, in the order of instances and descriptions. Throws InputError
/// for a pattern that fits nothing.
std::vector<ResolvedVariable> recorded_variables(const ResolvedSystem& system);

/// The variables that are recorded once, at t = 0: parameters of all kinds, and constants. Throws InputError.
std::vector<ResolvedVariable> recorded_parameters(const ResolvedSystem& system);

/// True when `text` fits a pattern in which `*` stands for any characters and `?` for one.
bool fits(std::string_view text, std::string_view pattern);

}  // namespace mebots::master
