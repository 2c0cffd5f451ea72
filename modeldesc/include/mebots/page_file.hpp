// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace mebots {

/// The parts of an HTML page, which are built from the folder web/.
struct PageParts {
  std::string frame;   ///< page.html, with the places of the others in it
  std::string script;  ///< page.js or report.js
  std::string style;   ///< page.css or report.css
};

/// Reads page.html, NAME.js and NAME.css from a folder, where NAME is `name`. Throws Error if a file cannot be read.
PageParts read_page_parts(const std::filesystem::path& folder, const std::string& name);

/// Returns an HTML document that contains the script and the data. The document needs no network. Script and data are
/// compressed (RFC 1950) and encoded in base64.
std::string fill_page(const PageParts& parts, const std::string& title, std::string_view data);

/// Returns the document of fill_page() without data. The page fetches the data only from its own server.
std::string fill_live_page(const PageParts& parts, const std::string& title);

}  // namespace mebots
