// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace mebots {

/// The parts of an HTML page. The build creates them from the folder web/.
struct PageParts {
  std::string frame;   ///< content of page.html, which has placeholders for the other parts
  std::string script;  ///< content of page.js or report.js
  std::string style;   ///< content of page.css or report.css
};

/// Reads page.html, NAME.js and NAME.css from a folder, where NAME is `name`. Throws Error if a file cannot be read.
PageParts read_page_parts(const std::filesystem::path& folder, const std::string& name);

/// Returns an HTML document that contains the script and the data, so it needs no network. Both are compressed (RFC
/// 1950) and encoded in base64.
std::string fill_page(const PageParts& parts, const std::string& title, std::string_view data);

/// Returns the document of fill_page() without data. The page in the browser fetches the data from its server.
std::string fill_live_page(const PageParts& parts, const std::string& title);

}  // namespace mebots
