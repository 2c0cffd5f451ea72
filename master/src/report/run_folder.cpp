// SPDX-License-Identifier: Apache-2.0
#include "report/run_folder.hpp"

#include "mebots/file_kind.hpp"

#include "base/input_text.hpp"
#include "base/packed.hpp"
#include "mebots/data/csv.hpp"
#include "mebots/parsed_number.hpp"
#include "run/system_file.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace mebots::master::report {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

Json read_json(const fs::path& file) {
  if (!fs::exists(file)) return nullptr;
  auto text = input_text(file);
  if (file.extension() == ".gz") {
    try {
      text = gunzipped(text);
    } catch (const Error& error) {
      throw InputError(error.code(), fmt::format("{}: {}", file.string(), error.what()));
    }
  }
  auto json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) {
    throw InputError(ErrorCode::syntax_error, fmt::format("{}: this file is damaged: it is not JSON", file.string()));
  }
  return json;
}

std::vector<fs::path> sorted_entries(const fs::path& folder) {
  std::vector<fs::path> entries;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) entries.push_back(entry.path());
  std::ranges::sort(entries);
  return entries;
}

/// Reads the pictures of one camera. Ignores files whose name is not a time.
PictureSeries read_series(const fs::path& folder, std::size_t known) {
  PictureSeries series;
  series.name = folder.filename().string();
  for (const auto& file : sorted_entries(folder)) {
    const auto time_s = parsed_number<double>(file.stem().string());
    if (file.extension() != ".png" || !time_s) continue;
    if (known > 0) {
      --known;
    } else {
      series.pictures.push_back({*time_s, input_text(file)});
    }
  }
  return series;
}

/// Reads the profiles of chip programs in the folder. fmu_soc writes a profile if its parameter `profile` names a file
/// in this folder.
std::vector<Json> read_profiles(const fs::path& folder) {
  std::vector<Json> profiles;
  for (const auto& file : sorted_entries(folder)) {
    const auto name = file.filename();
    if (file.extension() != ".json" || name == "summary.json" || name == kSystemFile) continue;
    const auto text = input_text(file);
    if (std::string_view(text).substr(0, 200).find("speedscope.app/file-format-schema.json") == std::string::npos)
      continue;
    profiles.push_back(read_json(file));
  }
  return profiles;
}

/// Returns the names of recorded Strings and Binaries.
std::set<std::string> texts_of(const nlohmann::json& system) {
  std::set<std::string> names;
  if (!system.is_object() || !system.contains("variables")) return names;
  for (const auto& [name, variable] : system["variables"].items()) {
    const auto type = variable.value("type", "");
    if (type == "String" || type == "Binary") names.insert(name);
  }
  return names;
}

}  // namespace

std::vector<PictureSeries> read_pictures(const fs::path& folder, std::size_t known) {
  std::vector<PictureSeries> found;
  for (const auto& entry : sorted_entries(folder / "pictures")) {
    if (auto series = read_series(entry, known); !series.pictures.empty()) found.push_back(std::move(series));
  }
  return found;
}

RunFolder read_side_files(const fs::path& folder) {
  RunFolder run;
  run.scene = read_json(folder / kSceneFile);
  run.profiles = read_profiles(folder);
  return run;
}

RunFolder read_run_folder(const fs::path& folder, const std::vector<TimeSpan>& whole) {
  const auto results = folder / "results.csv";
  if (!is_folder(folder)) {
    throw InputError(
        ErrorCode::file_not_found,
        fmt::format("{}: there is no such folder; name one that `mebots run --out` wrote", folder.string()));
  }
  if (!fs::exists(results)) {
    const bool only_hdf5 = fs::exists(folder / "results.h5");
    throw InputError(
        ErrorCode::file_not_found,
        fmt::format("{}: this is not the results folder of a run: it has no results.csv{}", folder.string(),
                    only_hdf5 ? "; run again with \"format\": \"both\" under \"record\"" : ""));
  }
  auto run = read_side_files(folder);
  run.pictures = read_pictures(folder);
  for (auto& series : run.pictures) fit_into_page(series, whole);
  const auto plain = fs::absolute(folder).lexically_normal();
  run.name = plain.has_filename() ? plain.filename().string() : plain.parent_path().filename().string();
  run.system = read_json(folder / kSystemFile);
  run.results = read_results(results, whole, texts_of(run.system));
  run.summary = read_json(folder / "summary.json");
  if (fs::exists(folder / "log.txt")) run.log = input_text(folder / "log.txt");
  return run;
}

}  // namespace mebots::master::report
