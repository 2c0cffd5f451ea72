// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::modeldesc {

/// What goes into an FMU.
struct FmuParts {
  std::filesystem::path description;                    // modelDescription.xml
  std::filesystem::path documentation;                  // index.html
  std::filesystem::path binary;                         // becomes binaries/linux64/<model identifier>.so
  std::filesystem::path icon;                           // model.png; may be empty
  std::filesystem::path license;                        // becomes documentation/licenses/license.txt; may be empty
  std::filesystem::path reference;                      // folder, becomes documentation/reference; may be empty
  std::vector<std::filesystem::path> libraries;         // beside the binary, under their SONAME
  std::filesystem::path parts;                          // list of other people's (parts.hpp); may be empty
  std::string license_id;                               // SPDX expression of `license`; may be empty
  std::vector<std::filesystem::path> resource_folders;  // their contents go to resources/
  std::vector<std::filesystem::path> resource_files;    // go to resources/
};

/// Writes the .fmu. Throws mebots::Error naming what is missing, also when the binary or a library beside it
/// needs one that neither travels along nor belongs to every Linux.
void pack_fmu(const std::filesystem::path& archive, const FmuParts& parts);

}  // namespace mebots::modeldesc
