// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "report/run_folder.hpp"

#include <span>
#include <string>

namespace mebots::master::report {

/// The runs as bytes for the page. The length of a header (32 bits, little-endian), the header, which is JSON, and then
/// blocks of bytes of which the header tells offset and length. web/src/data/payload.ts reads it.
///
/// A column of n numbers is 8 n bytes. Each number's 64 bits (IEEE 754), read as a whole number, less those of the one
/// before it, stand in byte planes. First the lowest byte of each, then the second of each, and so on. Neighbours in
/// time differ little, so that deflate finds the upper bytes in runs. A column that stands still is one number in the
/// header.
std::string payload_of(std::span<const RunFolder> runs);

/// As RFC 4648 has it. Throws Error for more than 2 GiB.
std::string base64(std::string_view bytes);

}  // namespace mebots::master::report
