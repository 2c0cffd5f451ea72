// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "report/run_folder.hpp"

#include <filesystem>
#include <span>
#include <string>

namespace mebots::master::report {

/// The parts of the page that the build made of web/.
struct PageParts {
  std::string frame;   ///< page.html, with the places of the others in it
  std::string script;  ///< page.js
  std::string style;   ///< page.css
};

/// Reads the parts. Throws Error for an installation that was built without them (MEBOTS_PAGES).
PageParts read_page_parts();

/// One HTML document that shows the runs, the first one in full and the others beside it, and asks nothing of any
/// network. Script and data are in it deflated (RFC 1950) in base64.
std::string make_page(const PageParts& parts, std::span<const RunFolder> runs);

/// The page of a run that is under way: it fetches its data from where it came from (`data`, beside it), and from
/// nowhere else.
std::string make_live_page(const PageParts& parts, const std::string& name);

}  // namespace mebots::master::report
