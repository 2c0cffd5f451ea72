// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace mebots {

enum class Packing {
  fast,   ///< fast compression, for use during a mission
  small,  ///< ten times as slow as `fast`; the result is 15 % smaller
};

/// Compresses bytes in the format of RFC 1950 (zlib), which browsers call "deflate". Throws Error.
std::string deflated(std::string_view bytes, Packing packing);

/// Compresses bytes to a gzip file (RFC 1952). Equal bytes give equal files, because the file contains no name and no
/// date. Throws Error.
std::string gzipped(std::string_view bytes, Packing packing);

}  // namespace mebots
