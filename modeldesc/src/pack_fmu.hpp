// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::modeldesc {

/// A third-party component of a product.
struct Part {
  std::string relation;        ///< "linked": its code is inside; "bundled": one of its files is; "needed": it is
                               ///< required but not included
  std::string name;            ///< name of the package
  std::string version;         ///< version of the package; may be empty
  std::string license;         ///< SPDX expression; empty if unknown
  std::string locator;         ///< package URL (purl); may be empty
  std::filesystem::path text;  ///< file that contains the licence's text; may be empty
};

/// Reads the output of MebotsParts.cmake. Each line is one part. The fields have the order of the members of Part,
/// separated by '|'. Throws mebots::Error with file and line.
std::vector<Part> read_parts(const std::filesystem::path& file);

/// The product that a bill of materials describes.
struct Product {
  std::string name;
  std::string version;  ///< may be empty
  std::string license;  ///< SPDX expression; empty = unknown
};

/// Returns a bill of materials in SPDX 2.3 JSON (https://spdx.github.io/spdx-spec/v2.3): the product, its parts, and
/// the relation of each part to the product. The same product and parts give the same bytes. The creation time is
/// $SOURCE_DATE_EPOCH. If this variable is not set, it is the time of the entries in MEbots' archives. The document's
/// name space contains a hash of the product, the parts and their relations.
std::string spdx_document(const Product& product, std::vector<Part> parts);

struct FmuParts {
  std::filesystem::path description;             // modelDescription.xml
  std::filesystem::path documentation;           // index.html
  std::filesystem::path binary;                  // becomes binaries/<platform>/<model identifier>.so or .dll
  std::filesystem::path icon;                    // model.png, FMI 3.0: terminalsAndIcons/icon.png; may be empty
  std::filesystem::path terminals;               // terminalsAndIcons.xml of FMI 3.0; may be empty or name an empty file
  std::filesystem::path license;                 // becomes documentation/licenses/license.txt; may be empty
  std::filesystem::path reference;               // folder; becomes documentation/reference; may be empty
  std::vector<std::filesystem::path> libraries;  // copied to the binary's folder, under their SONAME
  std::filesystem::path parts;                   // file for read_parts(); may be empty
  std::string license_id;                        // SPDX expression of `license`; may be empty
  std::vector<std::filesystem::path> resource_folders;  // the contents of these folders are copied to resources/
  std::vector<std::filesystem::path> resource_files;    // these files are copied to resources/
  std::filesystem::path sources;                        // folder; its contents are copied to sources/; may be empty
};

/// Packs the files into an .fmu. The header of the binary determines its platform. Throws mebots::Error with the name
/// of a missing file. Also throws if the binary or one of its libraries needs a library that is neither in the archive
/// nor part of every Linux or Windows.
void pack_fmu(const std::filesystem::path& archive, const FmuParts& parts);

}  // namespace mebots::modeldesc
