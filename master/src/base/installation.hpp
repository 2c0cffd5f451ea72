// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// Finds the files that belong to the running program. No path is compiled in. Therefore a build, an installation and a
/// Python package can be moved.
///
/// |                             | this code is in                         | data: fmus, configs, templates |
/// |-----------------------------|-----------------------------------------|--------------------------------|
/// | program of a build          | `bin/`                                  | `./`                           |
/// | program of an installation  | `bin/`                                  | `share/mebots/`                |
/// | Python package of a build   | `python/mebots/`                        | `./`                           |
/// | that of an installation     | `lib/python3.x/site-packages/mebots/`   | `share/mebots/`                |
/// | wheel                       | `mebots/`, its programs `mebots/bin/`   | `mebots/share/mebots/`         |
/// | somebody's own program      | anywhere                                | those of the `mebots` in PATH  |
namespace mebots::master {

/// Returns the possible paths of a file or folder of the data, the preferred path first. The paths need not exist.
std::vector<std::filesystem::path> data_places(std::string_view name);

/// Returns the possible paths of another MEbots program, the preferred path first. The paths need not exist.
std::vector<std::filesystem::path> program_places(std::string_view name);

/// Converts the paths to texts for an error message.
std::vector<std::string> as_texts(const std::vector<std::filesystem::path>& places);

/// Returns the first existing path in data_places(name). If none exists, throws Error with the searched paths.
std::filesystem::path own_data(std::string_view name);

}  // namespace mebots::master
