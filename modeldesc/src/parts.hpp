// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::modeldesc {

/// A piece of other people's software in a product.
struct Part {
  std::string relation;        ///< "linked": its code is inside; "bundled": a file of it is; "needed": it is not
  std::string name;            ///< of the package that it comes from
  std::string version;         ///< of the package; may be empty
  std::string license;         ///< SPDX expression; empty where nobody wrote it down
  std::string locator;         ///< package URL (purl); may be empty
  std::filesystem::path text;  ///< the licence's text; may be empty
};

/// Reads what MebotsParts.cmake writes: a line for each part, its fields in the order above, separated by '|'. Throws
/// mebots::Error naming file and line.
std::vector<Part> read_parts(const std::filesystem::path& file);

}  // namespace mebots::modeldesc
