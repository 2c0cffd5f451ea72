// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace mebots::modeldesc {

/// Writes an FMU with the binaries of several builds for different platforms. All must be builds of one FMU: the same
/// modelDescription.xml, and the same bytes in every other file that two of them have. The documentation is that of the
/// first; each further bill of materials is kept as documentation/sbom.<platform>.spdx.json. `target` may be one of the
/// archives. Throws mebots::Error that names archive and entry if files differ, or if two archives have binaries for
/// one platform.
void merge_fmus(const std::vector<std::filesystem::path>& archives, const std::filesystem::path& target);

}  // namespace mebots::modeldesc
