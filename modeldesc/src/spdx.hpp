// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "parts.hpp"

#include <string>
#include <vector>

namespace mebots::modeldesc {

/// What a bill of materials is about.
struct Product {
  std::string name;
  std::string version;  ///< may be empty
  std::string license;  ///< SPDX expression; empty = not said
};

/// The bill of materials as SPDX 2.3 JSON (https://spdx.github.io/spdx-spec/v2.3): the product, its parts, and how each
/// belongs to it. The same product and parts give the same bytes: the time is $SOURCE_DATE_EPOCH, or that of the
/// entries of our archives, and the document's name space holds the hash of the rest.
std::string spdx_document(const Product& product, std::vector<Part> parts);

}  // namespace mebots::modeldesc
