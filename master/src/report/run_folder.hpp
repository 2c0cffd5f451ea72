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
  std::string png;      ///< content of the file
  unsigned shrunk = 1;  ///< original pixels per pixel of the file, in each direction
};

/// The pictures of one camera in order of time.
struct PictureSeries {
  std::string name;  ///< "world.camera.frame"
  std::vector<Picture> pictures;
  std::size_t every = 1;  ///< 1 means that all pictures were kept, n that every n-th was
};

/// The maximum number of bytes of pictures in a page, so that the page can be sent by mail.
inline constexpr std::size_t kMostPictureBytes = 1'500'000;

/// Reduces the pictures to kMostPictureBytes. First averages 2 x 2 pixels repeatedly, down to a width of at least 128
/// pixels. If this is not enough, removes pictures evenly in time. Pictures within the spans `whole`, and files that
/// are not PNGs of grey pixels, do not change.
void fit_into_page(PictureSeries& series, const std::vector<TimeSpan>& whole);

/// The content of a run's folder. Only the table of results is always present. Each other member is empty if the run,
/// or an older version of mebots, did not write its file.
struct RunFolder {
  std::string name;  ///< readable name of the folder
  ResultTable results;
  nlohmann::json system;   ///< system.json, or null
  nlohmann::json summary;  ///< summary.json, or null if the run is in progress or was killed
  nlohmann::json scene;    ///< scene.json.gz, or null
  std::string log;         ///< log.txt
  std::vector<PictureSeries> pictures;
  std::vector<nlohmann::json> profiles;  ///< speedscope files, written by fmu_soc
  nlohmann::json live;                   ///< data of a run in progress (master/live), or null
};

/// Returns the pictures of a run. The run may still be in progress. Skips the first `known` pictures of each camera.
std::vector<PictureSeries> read_pictures(const std::filesystem::path& folder, std::size_t known = 0);

/// Reads the scene and the profiles. The run may still be in progress. Throws InputError for damaged files.
RunFolder read_side_files(const std::filesystem::path& folder);

/// Reads a results folder and reduces it to the size of a page. Within the spans `whole`, every row and picture is
/// kept. Throws InputError if the folder contains no results or a file is damaged.
RunFolder read_run_folder(const std::filesystem::path& folder, const std::vector<TimeSpan>& whole = {});

}  // namespace mebots::master::report
