// SPDX-License-Identifier: Apache-2.0
#include "fmi/windows/wine.hpp"

#include "base/installation.hpp"
#include "mebots/file_kind.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <span>
#include <sstream>
#include <string_view>

namespace mebots::master::windows {
namespace {

namespace fs = std::filesystem;

// Debian, Ubuntu, Fedora, Arch, and the packages of WineHQ.
constexpr auto kProgramPlaces = std::to_array<const char*>(
    {"/usr/lib/wine/wine64", "/usr/lib64/wine/wine64", "/opt/wine-stable/bin/wine64", "/opt/wine-stable/bin/wine"});
constexpr auto kLibraryPlaces = std::to_array<const char*>(
    {"/usr/lib/x86_64-linux-gnu/wine/x86_64-windows", "/usr/lib/wine/x86_64-windows", "/usr/lib64/wine/x86_64-windows",
     "/opt/wine-stable/lib64/wine/x86_64-windows", "/opt/wine-stable/lib/wine/x86_64-windows"});

fs::path first_of(std::span<const char* const> places) {
  for (const auto* place : places) {
    if (is_there(place)) return place;
  }
  return {};
}

fs::path find_program() {
  if (const char* chosen = std::getenv("MEBOTS_WINE"); chosen != nullptr && *chosen != '\0') return chosen;
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    for (const auto* name : {"wine64", "wine"}) {
      if (folder.starts_with('/') && is_file(fs::path(folder) / name)) return fs::path(folder) / name;
    }
  }
  return first_of(kProgramPlaces);
}

Wine find() {
  Wine wine{find_program(), first_of(kLibraryPlaces), {}, {}};
  for (const auto& place : program_places("mebots-windows-host.exe")) {
    if (wine.host.empty() && is_there(place)) wine.host = place;
  }
  if (!is_file(wine.program) || wine.libraries.empty()) {
    wine.missing = "Install wine, under which mebots runs it (`apt-get install wine64`)";
  } else if (wine.host.empty()) {
    wine.missing =
        "This build of MEbots lacks mebots-windows-host.exe, which runs it under wine: install "
        "g++-mingw-w64-x86-64-posix "
        "and build it again";
  }
  return wine;
}

}  // namespace

const Wine& find_wine() {
  static const Wine found = find();
  return found;
}

void create_wine_settings(const Wine& wine, const fs::path& folder) {
  const auto system = folder / "drive_c/windows/system32";
  fs::create_directories(system);
  fs::create_directory(folder / "dosdevices");
  fs::create_symlink("../drive_c", folder / "dosdevices/c:");
  fs::create_symlink("/", folder / "dosdevices/z:");
  for (const auto& entry : fs::directory_iterator(wine.libraries))
    fs::create_symlink(entry.path(), system / entry.path().filename());
  std::ofstream(folder / ".update-timestamp") << "disable\n";  // wine takes it for complete
}

}  // namespace mebots::master::windows
