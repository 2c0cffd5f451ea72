// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace mebots {

/// How many characters must be inserted, removed, replaced or swapped with a neighbour to get from one
/// text to the other; upper and lower case count as the same.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// A sentence for the end of an error message that offers the known names nearest to `wrong`:
/// "Did you mean 'x' or 'y'?", or, when none is near, a list of the known ones (shortened when long).
std::string suggest(std::string_view wrong, std::span<const std::string> known);

}  // namespace mebots
