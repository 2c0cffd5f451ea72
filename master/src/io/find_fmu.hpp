// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mebots::master {

/// True for a name without folder and suffix, such as "fmu_battery". Every other text is a path.
bool is_fmu_name(std::string_view text);

/// Returns the folders in which an FMU is searched by name, in this order:
///
/// 1. `beside`, which is the folder of the config,
/// 2. the folders in MEBOTS_FMU_PATH, separated by colons; relative paths are relative to the working folder,
/// 3. `fmus` of the running program's build, installation or Python package.
std::vector<std::filesystem::path> fmu_folders(const std::filesystem::path& beside);

/// Finds the FMUs of one config. Caches all answers, including negative ones, because a config may have 100,000
/// instances, usually of a few FMUs.
class FmuSearch {
 public:
  explicit FmuSearch(std::filesystem::path beside) : beside_(std::move(beside)) {}

  /// The result of a search. Exactly one of its two members is not empty.
  struct Answer {
    std::filesystem::path path;  // canonical path of the archive
    std::string problem;  // text that lists the searched places; the first problems also name FMUs with similar names
  };
  /// Finds the archive for `text`. `text` is a path relative to `beside`, or a name; a name denotes the first NAME.fmu
  /// in fmu_folders(). The answer is valid as long as this object exists.
  const Answer& find(std::string_view text);

 private:
  Answer look_for(std::string_view text);
  std::string problem_of_name(std::string_view name);

  std::filesystem::path beside_;
  std::map<std::string, Answer, std::less<>> answers_;
  std::size_t problems_ = 0;
  // Folders that are searched for names. Empty until the first search by name.
  std::optional<std::vector<std::filesystem::path>> folders_;
  std::string listed_;              // the folders as text for an error; empty until the first error
  std::vector<std::string> names_;  // sorted names of all FMUs in `folders_`; empty until the first error
};

/// Finds a single FMU and returns its path. Throws InputError if it does not exist.
std::filesystem::path find_fmu(std::string_view text, const std::filesystem::path& beside);

}  // namespace mebots::master
