// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace mebots {

/// Returns the version of the loaded library, such as "0.3.0".
std::string_view version() noexcept;

}  // namespace mebots
