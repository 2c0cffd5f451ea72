// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "support/files.hpp"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace mebots::system_test {

using mebots::test::Folder;
using mebots::test::read_file;

/// A config of the repository. Programs and FMUs of one build find each other by name.
nlohmann::ordered_json shipped_config(const std::string& name);

/// Writes a config and returns its path.
std::filesystem::path write(const std::filesystem::path& path, const nlohmann::ordered_json& config);

/// What one call of `mebots` left behind.
struct Flight {
  int exit_code = -1;
  std::string output;  ///< stdout and stderr
  nlohmann::json summary;
  std::string results;  ///< results.csv
};

/// `mebots run CONFIG --out OUT --set ...`
Flight fly(const std::filesystem::path& config, const std::filesystem::path& out,
           const std::vector<std::string>& sets = {}, const std::vector<std::string>& more = {});

/// The names in the header of results.csv, units left out, but for the time.
std::vector<std::string> column_names(const std::string& results);

/// A column of results.csv by "instance.variable".
std::vector<double> column(const std::string& results, const std::string& name);

}  // namespace mebots::system_test
