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

/// Returns the config `name` of the repository. It names FMUs without a path, because the programs of a build find the
/// FMUs of this build by name.
nlohmann::ordered_json shipped_config(const std::string& name);

/// Writes a config and returns its path.
std::filesystem::path write(const std::filesystem::path& path, const nlohmann::ordered_json& config);

/// The results of one call of `mebots`.
struct Flight {
  int exit_code = -1;
  std::string output;  ///< text on stdout and stderr
  nlohmann::json summary;
  std::string results;  ///< content of results.csv
};

/// Runs `mebots run CONFIG --out OUT --set SET... MORE...` and returns its results.
Flight fly(const std::filesystem::path& config, const std::filesystem::path& out,
           const std::vector<std::string>& sets = {}, const std::vector<std::string>& more = {});

/// Returns the columns of results.csv as text by "instance.variable", including the column of the time.
std::map<std::string, std::vector<std::string>> columns(const std::string& results);

/// Returns the column "instance.variable" of results.csv as numbers.
std::vector<double> column(const std::string& results, const std::string& name);

}  // namespace mebots::system_test
