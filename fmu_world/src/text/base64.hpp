// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace mebots::world {

/// RFC 4648 section 4: the standard alphabet, padded with '=', no line breaks.
std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace mebots::world
