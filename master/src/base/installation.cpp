// SPDX-License-Identifier: Apache-2.0
#include "base/installation.hpp"

#include "mebots/error.hpp"

#include <dlfcn.h>
#include <link.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <span>
#include <sstream>

namespace mebots::master {
namespace {

/// The program or shared object that contains this code.
struct Home {
  std::filesystem::path folder;
  bool is_extension;  // true for a shared object that Python has loaded; false for the program
};

Home find_home() {
  std::error_code ignored;
  Dl_info info{};
  link_map* object = nullptr;
  const bool known = dladdr1(reinterpret_cast<const void*>(&find_home), &info, reinterpret_cast<void**>(&object),
                             RTLD_DL_LINKMAP) != 0;
  // The loader stores an empty name for the program. /proc/self/exe contains its path, independently of argv[0].
  if (!known || object == nullptr || object->l_name == nullptr || object->l_name[0] == '\0') {
    return {std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path(), false};
  }
  return {std::filesystem::weakly_canonical(object->l_name, ignored).parent_path(), true};
}

const Home& home() {
  static const Home found = find_home();
  return found;
}

// Paths to the folders of data and programs, relative to the folder of the program or of the Python extension.
constexpr std::string_view kDataOfProgram[] = {"..", "../share/mebots"};
constexpr std::string_view kDataOfExtension[] = {"share/mebots", "../..", "../../../../share/mebots"};
constexpr std::string_view kProgramsOfProgram[] = {"."};
constexpr std::string_view kProgramsOfExtension[] = {"bin", "../../bin", "../../../../bin"};

void append(const std::filesystem::path& folder, std::span<const std::string_view> ways, std::string_view name,
            std::vector<std::filesystem::path>& places) {
  for (const auto way : ways) {
    auto place = (folder / way / name).lexically_normal();
    if (std::ranges::find(places, place) == places.end()) places.push_back(std::move(place));
  }
}

/// Returns the folder of the first `mebots` in PATH with resolved links; an empty path if PATH has no `mebots`.
std::filesystem::path folder_in_path() {
  const char* text = std::getenv("PATH");
  if (text == nullptr) return {};
  std::istringstream folders(text);
  std::error_code ignored;
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (folder.empty() || folder.front() != '/') continue;
    const auto program = std::filesystem::canonical(std::filesystem::path(folder) / "mebots", ignored);
    if (!ignored) return program.parent_path();
  }
  return {};
}

std::vector<std::filesystem::path> places(std::span<const std::string_view> of_program,
                                          std::span<const std::string_view> of_extension, std::string_view name) {
  std::vector<std::filesystem::path> places;
  append(home().folder, home().is_extension ? of_extension : of_program, name, places);
  if (const auto folder = folder_in_path(); !folder.empty()) append(folder, of_program, name, places);
  return places;
}

}  // namespace

std::vector<std::filesystem::path> data_places(std::string_view name) {
  return places(kDataOfProgram, kDataOfExtension, name);
}

std::vector<std::filesystem::path> program_places(std::string_view name) {
  return places(kProgramsOfProgram, kProgramsOfExtension, name);
}

std::vector<std::string> as_texts(const std::vector<std::filesystem::path>& places) {
  std::vector<std::string> texts;
  texts.reserve(places.size());
  for (const auto& place : places) texts.push_back(place.string());
  return texts;
}

std::filesystem::path own_data(std::string_view name) {
  const auto places = data_places(name);
  std::error_code ignored;
  const auto found =
      std::ranges::find_if(places, [&](const auto& place) { return std::filesystem::exists(place, ignored); });
  if (found != places.end()) return *found;
  throw Error(ErrorCode::file_not_found,
              fmt::format("this installation lacks {}: it was not found at {}; install MEbots again", name,
                          fmt::join(as_texts(places), ", ")));
}

}  // namespace mebots::master
