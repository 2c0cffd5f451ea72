// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace mebots {

/// The version of the library that runs, "0.3.0".
std::string_view version() noexcept;

}  // namespace mebots
