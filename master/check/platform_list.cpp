// SPDX-License-Identifier: Apache-2.0
#include "platform_list.hpp"

#include "mebots/error.hpp"
#include "mebots/modeldesc/elf_library.hpp"
#include "mebots/modeldesc/pe_library.hpp"
#include "mebots/modeldesc/platform.hpp"
#include "mebots/modeldesc/system_libraries.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>
#include <string_view>
#include <utility>

namespace mebots::check {
namespace {

namespace fs = std::filesystem;
using modeldesc::BinaryFormat;

using Version = std::pair<int, int>;

/// Parses a symbol version such as "GLIBC_2.34". Returns {0, 0} for other names.
Version glibc_version(std::string_view name) {
  constexpr std::string_view kStart = "GLIBC_";
  Version version{0, 0};
  if (!name.starts_with(kStart)) return version;
  name.remove_prefix(kStart.size());
  const auto dot = std::min(name.find('.'), name.size());
  std::from_chars(name.data(), name.data() + dot, version.first);
  if (dot < name.size()) std::from_chars(name.data() + dot + 1, name.data() + name.size(), version.second);
  return version;
}

bool is_there_without_case(const std::set<std::string>& names, const std::string& name) {
  const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  return std::ranges::any_of(names, [&](const std::string& own) { return std::ranges::equal(own, name, same); });
}

class FolderReader {
 public:
  explicit FolderReader(const fs::path& folder) {
    needs_.folder = folder.filename().string();
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
      if (!entry.is_regular_file(ignored)) continue;
      names_.insert(entry.path().filename().string());
      files_.insert(entry.path());
    }
  }

  PlatformNeeds read() {
    for (const auto& file : files_) {
      try {
        read_library(file);
      } catch (const Error&) {  // not a library, or the check of the binaries reports the error
        continue;
      }
    }
    if (glibc_.first != 0) needs_.glibc = fmt::format("{}.{}", glibc_.first, glibc_.second);
    needs_.missing.assign(missing_.begin(), missing_.end());
    return std::move(needs_);
  }

 private:
  void read_library(const fs::path& file) {
    const auto platforms = modeldesc::find_platforms(file);
    if (platforms.empty()) return;
    if (needs_.machine.empty()) {
      for (const auto* const platform : platforms)
        needs_.machine += fmt::format("{}{}", needs_.machine.empty() ? "" : " and ", platform->text);
    }
    if (platforms.front()->format == BinaryFormat::elf) read_elf(file);
    if (platforms.front()->format == BinaryFormat::pe) read_pe(file);
  }

  void read_elf(const fs::path& file) {
    const auto needs = modeldesc::read_elf_needs(file);
    for (const auto& version : needs.versions) glibc_ = std::max(glibc_, glibc_version(version));
    for (const auto& name : needs.libraries)
      if (!modeldesc::is_part_of_linux(name) && !names_.contains(name)) missing_.insert(name);
  }

  void read_pe(const fs::path& file) {
    for (const auto& name : modeldesc::read_pe_library(file).needed)
      if (!modeldesc::is_part_of_windows(name) && !is_there_without_case(names_, name)) missing_.insert(name);
  }

  PlatformNeeds needs_;
  std::set<std::string> names_;
  std::set<fs::path> files_;
  Version glibc_{0, 0};
  std::set<std::string> missing_;
};

}  // namespace

std::vector<PlatformNeeds> list_platforms(const fs::path& fmu) {
  std::vector<PlatformNeeds> list;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(fmu / "binaries", ignored)) {
    if (entry.is_directory(ignored)) list.push_back(FolderReader(entry.path()).read());
  }
  std::ranges::sort(list, {}, &PlatformNeeds::folder);
  return list;
}

std::string to_text(const PlatformNeeds& needs) {
  if (needs.machine.empty()) return "contains no library of a known platform";
  auto text = needs.machine;
  if (!needs.glibc.empty()) text += fmt::format(", glibc {} or newer", needs.glibc);
  if (!needs.missing.empty()) text += fmt::format(", needs {}", fmt::join(needs.missing, ", "));
  return text;
}

}  // namespace mebots::check
