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

/// True for a name such as "fmu_battery", without folder and suffix. Everything else is a path.
bool is_fmu_name(std::string_view text);

/// Returns the folders in which FMUs are searched by name, in this order:
///
/// 1. `beside`, the folder of the config,
/// 2. the folders in MEBOTS_FMU_PATH, separated by colons; relative paths start at the working folder,
/// 3. `fmus` of the running program's build, installation or Python package.
std::vector<std::filesystem::path> fmu_folders(const std::filesystem::path& beside);

/// Finds the FMUs of one config. Caches all answers, including "not found", because a config may have 100,000
/// instances, usually of a few FMUs.
class FmuSearch {
 public:
  explicit FmuSearch(std::filesystem::path beside) : beside_(std::move(beside)) {}

  /// The result of a search. Exactly one of the two members is set.
  struct Answer {
    std::filesystem::path path;  // canonical
    std::string problem;         // the searched places; in the first problems also the FMUs with similar names
  };
  /// Finds the archive for `text`: a path relative to `beside`, or a name, which means the first NAME.fmu in
  /// fmu_folders(). The answer is valid as long as this object.
  const Answer& find(std::string_view text);

 private:
  Answer look_for(std::string_view text);
  std::string problem_of_name(std::string_view name);

  std::filesystem::path beside_;
  std::map<std::string, Answer, std::less<>> answers_;
  std::size_t problems_ = 0;
  std::optional<std::vector<std::filesystem::path>> folders_;  // for names; empty until the first search by name
  std::string listed_;                                         // the folders formatted for an error; empty until the
                                                               // first error
  std::vector<std::string> names_;                             // of all FMUs in them, sorted; empty until the first
                                                               // error
};

/// Finds a single FMU. Throws InputError if there is none.
std::filesystem::path find_fmu(std::string_view text, const std::filesystem::path& beside);

}  // namespace mebots::master
