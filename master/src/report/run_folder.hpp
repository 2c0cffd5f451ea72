// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "report/picture_detail.hpp"
#include "report/result_table.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::master::report {

/// What a run left in its folder. Only the table of results is always there; all else is empty where the run, or an
/// older version that made it, left none.
struct RunFolder {
  std::string name;  ///< of the folder, for people
  ResultTable results;
  nlohmann::json system;   ///< of system.json, or null
  nlohmann::json summary;  ///< of summary.json, or null: of a run that is under way or was killed
  nlohmann::json scene;    ///< of scene.json.gz, or null
  std::string log;         ///< of log.txt
  std::vector<PictureSeries> pictures;
  std::vector<nlohmann::json> profiles;  ///< files of speedscope, as fmu_soc writes them
  nlohmann::json live;                   ///< of a run that is under way (master/live), or null
};

/// The pictures of a run, also while it is under way: of each camera those behind the first `known` ones.
std::vector<PictureSeries> read_pictures(const std::filesystem::path& folder, std::size_t known = 0);

/// What there is beside results, summary, system, log and pictures: scene and profiles, also while the run is under
/// way. Throws InputError for files that are damaged.
RunFolder read_side_files(const std::filesystem::path& folder);

/// Reads a results folder, as far as it fits into a page: within the spans `whole` every row of its table stays, and
/// every picture as it is. Throws InputError for a folder that is none, and for files in it that are damaged.
RunFolder read_run_folder(const std::filesystem::path& folder, const std::vector<TimeSpan>& whole = {});

}  // namespace mebots::master::report
