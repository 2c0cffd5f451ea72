// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// Finds the files of MEbots relative to the running program, so that a build, an installation or a Python package can
/// be moved.
///
/// |                             | this code is in                         | data: fmus, configs, templates |
/// |-----------------------------|-----------------------------------------|--------------------------------|
/// | program of a build          | `bin/`                                  | `./`                           |
/// | program of an installation  | `bin/`                                  | `share/mebots/`                |
/// | Python package of a build   | `python/mebots/`                        | `./`                           |
/// | that of an installation     | `lib/python3.x/site-packages/mebots/`   | `share/mebots/`                |
/// | wheel                       | `mebots/`, its programs `mebots/bin/`   | `mebots/share/mebots/`         |
/// | other program               | anywhere                                | those of the `mebots` in PATH  |
namespace mebots::master {

/// Returns the paths at which a data file or folder may be, in the order of the search. The paths need not exist.
std::vector<std::filesystem::path> data_places(std::string_view name);

/// Returns the paths at which another program of MEbots may be, in the order of the search. The paths need not exist.
std::vector<std::filesystem::path> program_places(std::string_view name);

std::vector<std::string> as_texts(const std::vector<std::filesystem::path>& places);

/// Returns the first existing path of data_places(). Throws Error with the searched paths if none exists.
std::filesystem::path own_data(std::string_view name);

}  // namespace mebots::master
