// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace mebots::master {

enum class Packing {
  fast,   ///< while a mission flies
  small,  ///< ten times as long, for 15 % less
};

/// Deflated as RFC 1950 has it, which browsers call "deflate". Throws Error.
std::string deflated(std::string_view bytes, Packing packing);

/// A file of gzip (RFC 1952), of no name and no date: the same bytes give the same file. Throws Error.
std::string gzipped(std::string_view bytes, Packing packing);

/// What is in a file of gzip of one part. Throws Error for bytes that are none, and for more than 256 MiB in it.
std::string gunzipped(std::string_view bytes);

}  // namespace mebots::master
