// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "report/result_table.hpp"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace mebots::master::report {

/// A picture that a run has written.
struct Picture {
  double time_s = 0;
  std::string png;      ///< content of the PNG file
  unsigned shrunk = 1;  ///< number of original pixels, in each direction, for one pixel of the file
};

/// The pictures of one camera, sorted by time.
struct PictureSeries {
  std::string name;  ///< name of the frame, such as "world.camera.frame"
  std::vector<Picture> pictures;
  std::size_t every = 1;  ///< n if only every n-th picture was kept; 1 if all were kept
};

/// The maximum number of bytes that pictures take in a page. With more bytes, the page would be too large to be sent by
/// mail.
inline constexpr std::size_t kMostPictureBytes = 1'500'000;

/// Reduces the pictures to kMostPictureBytes. First averages 2 x 2 pixels, repeatedly, as long as the result is at
/// least 128 pixels wide. If this is not enough, removes pictures evenly in time. Pictures within the spans `whole` do
/// not change, and neither do files that are not PNGs of grey pixels.
void fit_into_page(PictureSeries& series, const std::vector<TimeSpan>& whole);

/// The content of a run's folder. The table of results is always present. Any other member is empty if the run, or an
/// older version of mebots, did not write its file.
struct RunFolder {
  std::string name;  ///< name of the folder, for readers
  ResultTable results;
  nlohmann::json system;   ///< content of system.json, or null
  nlohmann::json summary;  ///< content of summary.json; null if the run is in progress or was killed
  nlohmann::json scene;    ///< content of scene.json.gz, or null
  std::string log;         ///< content of log.txt
  std::vector<PictureSeries> pictures;
  std::vector<nlohmann::json> profiles;  ///< speedscope files that fmu_soc wrote
  nlohmann::json live;                   ///< data of a run in progress (master/live); null for other runs
};

/// Returns the pictures in a run's folder, except the first `known` pictures of each camera. The run may be in
/// progress.
std::vector<PictureSeries> read_pictures(const std::filesystem::path& folder, std::size_t known = 0);

/// Reads the scene and the profiles in a run's folder. The run may be in progress. Throws InputError if a file is
/// damaged.
RunFolder read_side_files(const std::filesystem::path& folder);

/// Reads a results folder and reduces its content to the size of a page. Keeps every row and picture within the spans
/// `whole`. Throws InputError if the folder contains no results, or if a file is damaged.
RunFolder read_run_folder(const std::filesystem::path& folder, const std::vector<TimeSpan>& whole = {});

}  // namespace mebots::master::report
