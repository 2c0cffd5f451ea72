// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "report/result_table.hpp"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace mebots::master::report {

/// A picture of a run.
struct Picture {
  double time_s = 0;
  std::string png;      ///< the file's bytes
  unsigned shrunk = 1;  ///< pixels of the file per pixel, in each direction
};

/// The pictures of one camera, in the order of time.
struct PictureSeries {
  std::string name;  ///< "world.camera.frame"
  std::vector<Picture> pictures;
  std::size_t every = 1;  ///< kept one in this many
};

/// Most bytes of pictures in a page, so that people can still mail it.
inline constexpr std::size_t kMostPictureBytes = 1'500'000;

/// Makes the pictures fit into a page: first smaller, by means of 2 x 2 pixels, but not under 128 pixels of width;
/// then fewer, evenly in time. Those within the spans `whole` stay as they are. A file that is not a PNG of grey pixels
/// is not made smaller.
void fit_into_page(PictureSeries& series, const std::vector<TimeSpan>& whole);

/// The content of a run's folder. Only the table of results is always present. All else is empty if the run, or the
/// older version that wrote it, left none.
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

/// Returns the pictures of a run, also during the run. Skips the first `known` pictures of each camera.
std::vector<PictureSeries> read_pictures(const std::filesystem::path& folder, std::size_t known = 0);

/// Reads the further files: scene and profiles, also during the run. Throws InputError for damaged files.
RunFolder read_side_files(const std::filesystem::path& folder);

/// Reads a results folder and reduces it to the size of a page. Within the spans `whole`, every row and picture is
/// kept. Throws InputError if it is no results folder, and for damaged files.
RunFolder read_run_folder(const std::filesystem::path& folder, const std::vector<TimeSpan>& whole = {});

}  // namespace mebots::master::report
