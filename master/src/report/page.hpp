// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/page_file.hpp"
#include "report/run_folder.hpp"

#include <span>
#include <string>

namespace mebots::master::report {

/// Reads the parts of the page that shows runs. Throws Error if the installation was built without pages
/// (MEBOTS_PAGES).
PageParts read_page_parts();

/// Reads the parts of the page that shows the data of `make_data_page`: a study, or a replayed flight. Throws the same
/// errors as `read_page_parts`.
PageParts read_data_page_parts();

/// Returns an HTML document that shows the first run in full and compares the other runs with the first.
std::string make_page(const PageParts& parts, std::span<const RunFolder> runs);

/// Returns the page of a run in progress. The page requests data only from the server that sent it.
std::string make_live_page(const PageParts& parts, const std::string& name);

/// Returns a page that shows `data`, which is JSON (web/src/report/content.ts). The page needs no network.
std::string make_data_page(const PageParts& parts, const std::string& title, std::string_view data);

/// Returns the runs as bytes for the page. The bytes consist of the length of the header (32 bits, little-endian), the
/// header as JSON, and blocks of bytes whose offsets and lengths are in the header. web/src/data/payload.ts reads these
/// bytes.
///
/// A column of n numbers takes 8 n bytes. The 64 bits of each number (IEEE 754) are treated as a whole number. From
/// each whole number, the previous one is subtracted. The differences are stored in byte planes: first the lowest byte
/// of each difference, then the second byte of each, and so on. Successive values differ little, so their upper bytes
/// compress well. A constant column is a single number in the header.
std::string payload_of(std::span<const RunFolder> runs);

}  // namespace mebots::master::report
