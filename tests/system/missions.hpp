// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "support/files.hpp"

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace mebots::system_test {

using mebots::test::Folder;
using mebots::test::read_file;

/// Returns a config of the repository. It names FMUs without a path, because the programs of a build find the FMUs of
/// this build by their names.
nlohmann::ordered_json shipped_config(const std::string& name);

/// Writes a config and returns its path.
std::filesystem::path write(const std::filesystem::path& path, const nlohmann::ordered_json& config);

/// The results of one call of `mebots`.
struct Flight {
  int exit_code = -1;
  std::string output;  ///< stdout and stderr
  nlohmann::json summary;
  std::string results;  ///< results.csv
};

/// Runs `mebots run CONFIG --out OUT --set ...`.
Flight fly(const std::filesystem::path& config, const std::filesystem::path& out,
           const std::vector<std::string>& sets = {}, const std::vector<std::string>& more = {});

/// Returns the columns of results.csv, the time's included, as text, by "instance.variable".
std::map<std::string, std::vector<std::string>> columns(const std::string& results);

/// Returns the numbers of a column of results.csv, by "instance.variable".
std::vector<double> column(const std::string& results, const std::string& name);

}  // namespace mebots::system_test
