// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "check_fmu.hpp"

#include "mebots/modeldesc/archive.hpp"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace mebots::check {

/// Returns the description of culprit.cpp, with its fault in the GUID.
std::string culprit_description(const std::string& crime);

/// A folder for archives of FMUs with any entries.
class Workshop {
 public:
  /// Writes an archive with these entries (name, content) in order.
  std::filesystem::path archive(const std::vector<std::pair<std::string, std::string>>& entries);
  /// Writes a complete FMU with the culprit's library and further entries.
  std::filesystem::path culprit(const std::string& crime, std::vector<std::pair<std::string, std::string>> more = {});
  /// Writes a complete FMU with the culprit's library, this description and further entries.
  std::filesystem::path culprit_with(const std::string& description,
                                     std::vector<std::pair<std::string, std::string>> more = {});
  /// Writes an FMU like culprit.cpp's, with another description.
  std::filesystem::path described(const std::string& description);

 private:
  modeldesc::TemporaryFolder folder_{"mebots-check-test"};
  int made_ = 0;
};

/// Returns all findings as "error: text" and "warning: text".
std::vector<std::string> findings(const Report& report);
/// Returns the findings about one FMU. Its code runs only if requested.
std::vector<std::string> findings(const std::filesystem::path& fmu, bool run = false, double deadline_s = 30,
                                  Level level = Level::pedantic);

}  // namespace mebots::check
