// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace mebots::new_fmu {

/// The files of a new FMU's folder: path inside it, and text.
using Files = std::vector<std::pair<std::filesystem::path, std::string>>;

/// Writes a folder that builds, from a description.json: model (a first-order lag between the variables that the
/// description declares), binding, test, README, CMakeLists.txt. `folder` empty = the FMU's name in the working folder.
/// Returns the folder. Throws mebots::Error for a description that cannot be read, or a folder that is there already:
/// nothing is ever overwritten.
std::filesystem::path new_fmu(const std::filesystem::path& description, std::filesystem::path folder);

}  // namespace mebots::new_fmu
