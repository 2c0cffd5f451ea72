// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "report/result_table.hpp"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace mebots::master::report {

struct Picture {
  double time_s = 0;
  std::string png;      ///< content of the PNG file
  unsigned shrunk = 1;  ///< width and height of a pixel, in original pixels
};

/// The pictures of one camera, sorted by time.
struct PictureSeries {
  std::string name;  ///< name of the frame, such as "world.camera.frame"
  std::vector<Picture> pictures;
  std::size_t every = 1;  ///< n if only every n-th picture was kept; 1 if all were kept
};

/// Maximum number of bytes of pictures in a page. A larger page would be too large for mail.
inline constexpr std::size_t kMostPictureBytes = 1'500'000;

/// Reduces the pictures to kMostPictureBytes. First halves width and height repeatedly, as long as at least 128 pixels
/// of width remain. If this is not enough, removes pictures evenly in time. Neither shrinks nor removes pictures within
/// the spans `whole`. Does not shrink files that are not grey PNGs.
void fit_into_page(PictureSeries& series, const std::vector<TimeSpan>& whole);

/// The content of a results folder. `results` is always present. Other members are empty if the folder lacks their
/// file.
struct RunFolder {
  std::string name;
  ResultTable results;
  nlohmann::json system;   ///< content of system.json, or null
  nlohmann::json summary;  ///< content of summary.json; null for a run in progress or a killed run
  nlohmann::json scene;    ///< content of scene.json.gz, or null
  std::string log;         ///< content of log.txt
  std::vector<PictureSeries> pictures;
  std::vector<nlohmann::json> profiles;  ///< speedscope files of fmu_soc
  nlohmann::json live;                   ///< data of a run in progress (master/live), or null
};

/// Returns the pictures of a run, except the first `known` pictures of each camera. The run may be in progress.
std::vector<PictureSeries> read_pictures(const std::filesystem::path& folder, std::size_t known = 0);

/// Reads scene and profiles from a results folder. The run may be in progress. Throws InputError if a file is damaged.
RunFolder read_side_files(const std::filesystem::path& folder);

/// Reads a results folder and reduces its content to the size of a page. Keeps every row and picture within the spans
/// `whole`. Throws InputError if the folder contains no results or a damaged file.
RunFolder read_run_folder(const std::filesystem::path& folder, const std::vector<TimeSpan>& whole = {});

}  // namespace mebots::master::report
