// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "finding.hpp"

#include <filesystem>

struct zip;  // libzip's zip_t

namespace mebots::check {

/// Looks at the names, kinds and sizes of an archive's entries without unpacking anything.
/// Throws mebots::Error when the file is not a zip archive at all.
void check_archive(const std::filesystem::path& archive, Findings findings);
/// The same of an archive that is open: libzip's zip_t.
void check_archive(zip& archive, Findings findings);

}  // namespace mebots::check
