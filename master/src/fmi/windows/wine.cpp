// SPDX-License-Identifier: Apache-2.0
#include "fmi/windows/wine.hpp"

#include "base/installation.hpp"
#include "mebots/file_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

namespace mebots::master::windows {
namespace {

namespace fs = std::filesystem;

// Paths of wine in Debian, Ubuntu, Fedora, Arch and the packages of WineHQ.
constexpr auto kProgramPlaces = std::to_array<const char*>(
    {"/usr/lib/wine/wine64", "/usr/lib64/wine/wine64", "/opt/wine-stable/bin/wine64", "/opt/wine-stable/bin/wine"});
constexpr auto kLibraryFolders = std::to_array<const char*>(
    {"/usr/lib/x86_64-linux-gnu", "/usr/lib", "/usr/lib64", "/opt/wine-stable/lib64", "/opt/wine-stable/lib"});
constexpr const char* kProgramVariable = "MEBOTS_WINE";

/// Returns the value of MEBOTS_WINE; an empty path if it is not set.
fs::path chosen_program() {
  const char* chosen = std::getenv(kProgramVariable);
  return chosen == nullptr ? "" : chosen;
}

fs::path find_program() {
  if (auto chosen = chosen_program(); !chosen.empty()) return chosen;
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    for (const auto* name : {"wine64", "wine"}) {
      if (folder.starts_with('/') && is_file(fs::path(folder) / name)) return fs::path(folder) / name;
    }
  }
  const auto* const place = std::ranges::find_if(kProgramPlaces, [](const char* one) { return is_there(one); });
  return place == kProgramPlaces.end() ? "" : *place;
}

/// Returns the folder with wine's DLLs; an empty path if no folder contains them. Searches next to `program` first,
/// because `program` cannot use the DLLs of another version.
fs::path find_libraries(const fs::path& program) {
  std::vector<fs::path> folders(kLibraryFolders.begin(), kLibraryFolders.end());
  std::error_code missing;
  const auto real = fs::canonical(program, missing);
  if (!missing) {
    const auto own = real.parent_path().parent_path();
    folders.insert(folders.begin(), {own / "lib64", own / "lib"});
  }
  for (const auto& folder : folders) {
    auto libraries = folder / "wine/x86_64-windows";
    if (is_there(libraries)) return libraries;
  }
  return {};
}

Wine find() {
  const auto program = find_program();
  Wine wine{program, find_libraries(program), {}, {}};
  for (const auto& place : program_places("mebots-windows-host.exe")) {
    if (wine.host.empty() && is_there(place)) wine.host = place;
  }
  if (!is_file(wine.program) && !chosen_program().empty()) {
    wine.missing = fmt::format("Set {} to wine's program, or unset it: there is no file {}", kProgramVariable,
                               wine.program.string());
  } else if (!is_file(wine.program) || wine.libraries.empty()) {
    wine.missing = "Install wine, under which mebots runs it (`apt-get install wine64`)";
  } else if (wine.host.empty()) {
    wine.missing =
        "This build of MEbots lacks mebots-windows-host.exe, which runs it under wine: install "
        "g++-mingw-w64-x86-64-posix and build it again";
  }
  return wine;
}

}  // namespace

const Wine& find_wine() {
  static const Wine found = find();
  return found;
}

void create_wine_settings(const fs::path& folder) {
  const auto system = folder / "drive_c/windows/system32";
  fs::create_directories(system);
  fs::create_directory(folder / "dosdevices");
  fs::create_symlink("../drive_c", folder / "dosdevices/c:");
  fs::create_symlink("/", folder / "dosdevices/z:");
  for (const auto& entry : fs::directory_iterator(find_wine().libraries))
    fs::create_symlink(entry.path(), system / entry.path().filename());
  std::ofstream(folder / ".update-timestamp") << "disable\n";  // prevents wine from updating the folder
}

}  // namespace mebots::master::windows
