// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace mebots {

/// Returns the edit distance: the number of insertions, removals, replacements and swaps of neighbouring characters
/// that change one text into the other. Ignores case.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// Returns the end of an error message, such as "Did you mean 'x' or 'y'?", with the known names nearest to `wrong`. If
/// no name is similar, lists the known names. Shortens a long list.
std::string suggest(std::string_view wrong, std::span<const std::string> known);

}  // namespace mebots
