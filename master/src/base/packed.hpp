// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/packed.hpp"

#include <string>
#include <string_view>

namespace mebots::master {

/// Unpacks a gzip file with one member and returns the content. Throws Error if the bytes are not such a file, or if
/// the content has more than 256 MiB.
std::string gunzipped(std::string_view bytes);

}  // namespace mebots::master
