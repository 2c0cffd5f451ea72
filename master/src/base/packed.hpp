// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/packed.hpp"

#include <string>
#include <string_view>

namespace mebots::master {

/// Decompresses a gzip file with one member. Throws Error if the bytes are not such a file, or if the result is larger
/// than 256 MiB.
std::string gunzipped(std::string_view bytes);

}  // namespace mebots::master
