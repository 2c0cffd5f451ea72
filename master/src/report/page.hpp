// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/page_file.hpp"
#include "report/run_folder.hpp"

#include <span>
#include <string>

namespace mebots::master::report {

/// Returns the parts of the page for runs. Throws Error if MEbots was built without web pages (MEBOTS_PAGES).
PageParts read_page_parts();

/// Returns the parts of the page for make_data_page(). Throws Error if MEbots was built without web pages
/// (MEBOTS_PAGES).
PageParts read_data_page_parts();

/// Returns an HTML document that shows the first run in detail and compares it with the other runs.
std::string make_page(const PageParts& parts, std::span<const RunFolder> runs);

/// Returns an HTML document that shows a run in progress. The page loads data only from the server that sent it.
std::string make_live_page(const PageParts& parts, const std::string& name);

/// Returns an HTML document that shows `data`, which must be JSON as in web/src/report/content.ts. The page works
/// without a network.
std::string make_data_page(const PageParts& parts, const std::string& title, std::string_view data);

/// Encodes runs for the page: the length of the header (32 bits, little-endian), the header as JSON, and blocks of
/// bytes. The header contains offsets and lengths of the blocks. web/src/data/payload.ts reads this format.
///
/// A column of n numbers takes 8 n bytes. The bits of each number are treated as an integer, and the previous integer
/// is subtracted. The differences are stored in byte planes: first the lowest byte of each difference, then the second
/// byte of each, and so on. Successive values differ little, so the upper bytes compress well. A constant column is a
/// single number in the header.
std::string payload_of(std::span<const RunFolder> runs);

}  // namespace mebots::master::report
