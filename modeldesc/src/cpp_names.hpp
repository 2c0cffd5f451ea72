// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace mebots::modeldesc {

/// True for a name that C++ takes for a variable: letters, digits, `_`, and no keyword.
bool is_cpp_identifier(std::string_view name);

/// True for `a::b::c`.
bool is_cpp_namespace(std::string_view name);

/// True for FMI's structured names: identifiers with `[n]` behind them, joined by dots.
bool is_structured_name(std::string_view name);

/// The FMI name as a C++ one: `.`, `[` and `]` become `_`, none doubled and none at the end.
std::string to_cpp_name(std::string_view fmi_name);

/// The text as a C++ string literal, quotes included.
std::string cpp_literal(std::string_view text);

}  // namespace mebots::modeldesc
