// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

namespace mebots::master {

/// True for "fmu_battery": neither folder nor suffix. Everything else is a path.
bool is_fmu_name(std::string_view text);

/// Folders in which an FMU is looked for by its name, in this order:
///
/// 1. `beside`, the folder of the config,
/// 2. those of MEBOTS_FMU_PATH, separated by colons; relative ones count from the working folder,
/// 3. `fmus` of the running program's build, installation or Python package.
std::vector<std::filesystem::path> fmu_folders(const std::filesystem::path& beside);

/// The archive that `text` means: a path relative to `beside`, or a name, which stands for the first NAME.fmu of
/// fmu_folders(). Canonical. Throws InputError, which lists the places looked at and the FMUs with similar names.
std::filesystem::path find_fmu(std::string_view text, const std::filesystem::path& beside);

}  // namespace mebots::master
