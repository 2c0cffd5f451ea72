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

/// The subject of a bill of materials.
struct Product {
  std::string name;
  std::string version;  ///< may be empty
  std::string license;  ///< SPDX expression; empty = unknown
};

/// The bill of materials as SPDX 2.3 JSON (https://spdx.github.io/spdx-spec/v2.3): the product, its parts, and how each
/// belongs to it. The same product and parts give the same bytes: the time is $SOURCE_DATE_EPOCH, or that of the
/// entries of our archives, and the document's name space holds the hash of the rest.
std::string spdx_document(const Product& product, std::vector<Part> parts);

/// What goes into an FMU.
struct FmuParts {
  std::filesystem::path description;             // modelDescription.xml
  std::filesystem::path documentation;           // index.html
  std::filesystem::path binary;                  // becomes binaries/<platform>/<model identifier>.so
  std::filesystem::path icon;                    // model.png, FMI 3.0: terminalsAndIcons/icon.png; may be empty
  std::filesystem::path terminals;               // terminalsAndIcons.xml of FMI 3.0; may be empty, or an empty file
  std::filesystem::path license;                 // becomes documentation/licenses/license.txt; may be empty
  std::filesystem::path reference;               // folder, becomes documentation/reference; may be empty
  std::vector<std::filesystem::path> libraries;  // beside the binary, under their SONAME
  std::filesystem::path parts;                   // list of other people's (parts.hpp); may be empty
  std::string license_id;                        // SPDX expression of `license`; may be empty
  std::vector<std::filesystem::path> resource_folders;  // their contents go to resources/
  std::vector<std::filesystem::path> resource_files;    // go to resources/
};

/// Writes the .fmu. Throws mebots::Error naming what is missing, also when the binary or a library beside it
/// needs one that neither travels along nor belongs to every Linux.
void pack_fmu(const std::filesystem::path& archive, const FmuParts& parts);

}  // namespace mebots::modeldesc
