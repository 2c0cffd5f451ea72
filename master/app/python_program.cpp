// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"

#include "base/installation.hpp"
#include "mebots/input_error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>

namespace mebots::app {
namespace {

using Path = std::filesystem::path;

/// Python code that calls the command. If the import fails, prints the error as one line.
constexpr const char* kStart =
    "import sys\n"
    "try:\n"
    "    from {} import main\n"
    "except ImportError as error:\n"
    "    print(f'mebots: error: Python {{sys.version.split()[0]}} at {{sys.executable}} cannot load the package '\n"
    "          f'mebots: {{error}}. MEBOTS_PYTHON names another Python', file=sys.stderr)\n"
    "    sys.exit(2)\n"
    "sys.exit(main())\n";

/// Returns the folder that contains the package: `python` next to `bin` in a build, `lib/python3.x/site-packages` or
/// `lib/python3/dist-packages` in an installation. In a wheel, the package contains `bin`.
Path package_folder(const std::string& command) {
  std::vector<Path> places;
  for (const auto& program : master::program_places("mebots")) {
    const auto root = program.parent_path().parent_path();
    places.push_back(root / "python");
    std::error_code none;
    std::vector<Path> versions;
    for (const auto& entry : std::filesystem::directory_iterator(root / "lib", none)) {
      if (!entry.path().filename().string().starts_with("python3")) continue;
      for (const auto* packages : {"site-packages", "dist-packages"}) versions.push_back(entry.path() / packages);
    }
    std::ranges::sort(versions, std::greater<>());
    places.insert(places.end(), versions.begin(), versions.end());
    places.push_back(root.parent_path());
  }
  const auto found = std::ranges::find_if(
      places, [](const Path& place) { return std::filesystem::exists(place / "mebots" / "exploration"); });
  if (found != places.end()) return *found;
  throw InputError(
      ErrorCode::not_offered,
      fmt::format("`{}` needs the Python package mebots, which was not found ({}): build MEbots with Python "
                  "(python3-dev, pybind11-dev)",
                  command, fmt::join(master::as_texts(places), ", ")));
}

/// Sets PATH if it is missing or empty. Studies start `python3`, and Python needs PATH to find this program.
void ensure_path() {
  const char* path = std::getenv("PATH");
  if (path == nullptr || *path == '\0') setenv("PATH", "/usr/local/bin:/usr/bin:/bin", 1);
}

}  // namespace

void become_python(const std::string& command, const std::string& module, const std::vector<std::string>& words) {
  auto path = package_folder(command).string();
  if (const char* given = std::getenv("PYTHONPATH"); given != nullptr && *given != '\0')
    path += ":" + std::string(given);
  setenv("PYTHONPATH", path.c_str(), 1);
  ensure_path();
  const char* named = std::getenv("MEBOTS_PYTHON");
  std::string python = named != nullptr && *named != '\0' ? named : "python3";
  std::vector<std::string> all = {python, "-c", fmt::format(kStart, module)};
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> arguments;
  arguments.reserve(all.size() + 1);
  for (auto& word : all) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  std::fflush(nullptr);  // execvp() discards buffered output
  execvp(python.c_str(), arguments.data());
  throw InputError(
      ErrorCode::not_offered,
      fmt::format("`{}` needs {}, which cannot be started: {}. Install python3, or set MEBOTS_PYTHON to another Python",
                  command, python, std::strerror(errno)));
}

}  // namespace mebots::app
