// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace mebots::new_folder {

/// Words of a template and what stands for them, in names of files and in texts.
using Words = std::vector<std::pair<std::string, std::string>>;

/// The files of a template: path inside it, and text.
using Files = std::vector<std::pair<std::filesystem::path, std::string>>;

/// Reads templates/`name`, words replaced, by path.
Files read_template(const std::string& name, const Words& words);

/// Throws Error unless `name` can name a C function, a device and a CMake target: lower-case letters, digits and _,
/// and none of the words that the templates use themselves.
void require_name(const std::string& name);

/// Writes the files into a new folder. Throws Error when it exists.
void write_folder(const std::filesystem::path& folder, const Files& files);

std::string read_text(const std::filesystem::path& file);

}  // namespace mebots::new_folder
