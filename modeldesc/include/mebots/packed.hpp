// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace mebots {

enum class Packing {
  fast,   ///< for use during a mission
  small,  ///< ten times as slow, for 15 % less
};

/// Compresses as in RFC 1950, which browsers call "deflate". Throws Error.
std::string deflated(std::string_view bytes, Packing packing);

/// Returns a gzip file (RFC 1952) without name and date: equal bytes give equal files. Throws Error.
std::string gzipped(std::string_view bytes, Packing packing);

}  // namespace mebots
