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

/// True for a name without folder and suffix, such as "fmu_battery". All other texts are paths.
bool is_fmu_name(std::string_view text);

/// Returns the folders in which an FMU is searched by name, in this order:
///
/// 1. `config_folder`, the folder of the config,
/// 2. the folders in MEBOTS_FMU_PATH, separated by colons; relative paths are relative to the working folder,
/// 3. `fmus` of the running program's build, installation or Python package.
std::vector<std::filesystem::path> fmu_folders(const std::filesystem::path& config_folder);

/// Finds the FMUs of a config. Caches all results, because a config may have 100,000 instances of a few FMUs.
class FmuSearch {
 public:
  explicit FmuSearch(std::filesystem::path config_folder) : config_folder_(std::move(config_folder)) {}

  /// The result of a search. Either `path` or `problem` is empty.
  struct Answer {
    std::filesystem::path path;  // canonical path of the archive
    std::string problem;         // the searched places; in the first problems, also FMUs with similar names
  };
  /// Finds an FMU by its path or name. A path is relative to `config_folder`. A name selects the first NAME.fmu in
  /// fmu_folders(). The result is valid during the lifetime of this object.
  const Answer& find(std::string_view text);

 private:
  Answer look_for(std::string_view text);
  std::string problem_of_name(std::string_view name);

  std::filesystem::path config_folder_;
  std::map<std::string, Answer, std::less<>> answers_;
  std::size_t problems_ = 0;
  // The folders in which an FMU is searched by name (see fmu_folders()). Empty until the first such search.
  std::optional<std::vector<std::filesystem::path>> folders_;
  std::string listed_;              // folders_ as text for an error; empty until the first error
  std::vector<std::string> names_;  // sorted names of all FMUs in folders_; empty until the first error
};

/// Returns the path of a single FMU. Throws InputError if it does not exist.
std::filesystem::path find_fmu(std::string_view text, const std::filesystem::path& config_folder);

}  // namespace mebots::master
