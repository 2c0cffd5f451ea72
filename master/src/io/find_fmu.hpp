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

/// True for "fmu_battery": neither folder nor suffix. Everything else is a path.
bool is_fmu_name(std::string_view text);

/// Folders in which an FMU is looked for by its name, in this order:
///
/// 1. `beside`, the folder of the config,
/// 2. those of MEBOTS_FMU_PATH, separated by colons; relative ones count from the working folder,
/// 3. `fmus` of the running program's build, installation or Python package.
std::vector<std::filesystem::path> fmu_folders(const std::filesystem::path& beside);

/// Finds the FMUs of one config. What was asked for before is answered from memory, also when it is not there: a config
/// has up to 100,000 instances, most often of a few FMUs.
class FmuSearch {
 public:
  explicit FmuSearch(std::filesystem::path beside) : beside_(std::move(beside)) {}

  /// One of the two is empty.
  struct Answer {
    std::filesystem::path path;  // canonical
    std::string problem;         // the places looked at and, in the first problems, the FMUs with similar names
  };
  /// The archive that `text` means: a path relative to `beside`, or a name, which stands for the first NAME.fmu of
  /// fmu_folders(). The answer lives as long as this object.
  const Answer& find(std::string_view text);

 private:
  Answer look_for(std::string_view text);
  std::string problem_of_name(std::string_view name);

  std::filesystem::path beside_;
  std::map<std::string, Answer, std::less<>> answers_;
  std::size_t problems_ = 0;
  std::optional<std::vector<std::filesystem::path>> folders_;  // for names, once one is asked for
  std::string listed_;                                         // the folders as an error lists them, once it has to
  std::vector<std::string> names_;                             // of all FMUs in them, sorted, likewise
};

/// The same for a single FMU. Throws InputError with the problem.
std::filesystem::path find_fmu(std::string_view text, const std::filesystem::path& beside);

}  // namespace mebots::master
