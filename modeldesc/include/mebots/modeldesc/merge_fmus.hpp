// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace mebots::modeldesc {

/// Merges several builds of one FMU for different platforms into one FMU at `target`. All archives must have the same
/// modelDescription.xml. Any other file that is in two archives must have the same bytes in both. The documentation
/// comes from the first archive. The bill of materials of each further archive is stored as
/// documentation/sbom.<platform>.spdx.json. `target` may be one of the archives. Throws mebots::Error with archive and
/// entry if files differ, or if two archives have binaries for one platform.
void merge_fmus(const std::vector<std::filesystem::path>& archives, const std::filesystem::path& target);

}  // namespace mebots::modeldesc
