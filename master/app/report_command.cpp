// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"

#include "mebots/data/csv.hpp"
#include "mebots/input_error.hpp"
#include "mebots/parsed_number.hpp"
#include "record/sink/output_file.hpp"
#include "report/page.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace mebots::app {

using namespace mebots::master;

namespace {

/// Writes the page. Reduces long tables, but keeps all rows within the time spans `whole`.
std::filesystem::path write_page(const std::vector<std::filesystem::path>& folders, std::filesystem::path file,
                                 const std::vector<report::TimeSpan>& whole) {
  const auto parts = report::read_page_parts();
  std::vector<report::RunFolder> runs;
  runs.reserve(folders.size());
  for (const auto& folder : folders) runs.push_back(report::read_run_folder(folder, whole));
  if (file.empty()) file = folders.front() / "flight.html";
  write_whole(file, report::make_page(parts, runs));
  return file;
}

}  // namespace

std::filesystem::path write_report(const std::vector<std::filesystem::path>& folders, std::filesystem::path file) {
  return write_page(folders, std::move(file), {});
}

namespace {

struct PageOptions {
  std::vector<std::filesystem::path> folders;
  std::filesystem::path out;
  std::vector<std::string> detail;
  std::filesystem::path mcap;
  std::filesystem::path video;
  unsigned frames_per_second = 15;
  double video_speed = 1;
};

/// Parses a span such as "120:130" or "all". "all" ends at the largest double, because JSON has no infinity.
report::TimeSpan time_span(const std::string& text) {
  if (text == "all") return {0, std::numeric_limits<double>::max()};
  const auto colon = text.find(':');
  const auto from_s = parsed_number<double>(text.substr(0, colon));
  const auto to_s = colon == std::string::npos ? std::nullopt : parsed_number<double>(text.substr(colon + 1));
  if (!from_s || !to_s || !(*from_s <= *to_s)) {
    throw InputError(
        ErrorCode::invalid_value,
        fmt::format("--detail {}: two times are expected, the earlier one first, such as 120:130 [s], or all", text));
  }
  return {*from_s, *to_s};
}

void report_runs(const PageOptions& options) {
  std::vector<report::TimeSpan> whole;
  for (const auto& text : options.detail) whole.push_back(time_span(text));
  const auto page = write_page(options.folders, options.out, whole);
  std::printf("page: %s\n", page.string().c_str());
  if (options.mcap.empty() && options.video.empty()) return;
  std::vector<std::string> words = {options.folders.front().string(), page.string()};
  if (!options.mcap.empty()) {
    require_folder_of(options.mcap);
    words.insert(words.end(), {"--mcap", options.mcap.string()});
  }
  if (!options.video.empty()) {
    require_folder_of(options.video);
    words.insert(words.end(),
                 {"--video", options.video.string(), "--frames-per-second", std::to_string(options.frames_per_second),
                  "--speed", fmt::format("{}", options.video_speed)});
  }
  become_python("mebots report --mcap, --video", "mebots.export.command", words);
}

}  // namespace

void add_report(CLI::App& app, Action& action) {
  const auto options = std::make_shared<PageOptions>();
  auto* command = app.add_subcommand("report", "Write an HTML report of one run, or compare several runs");
  command->add_option("folders", options->folders, "Results folders; the first is shown in full")
      ->type_name("FOLDER")
      ->required();
  command->add_option("--out", options->out, "File of the page; default: flight.html in the first folder")
      ->type_name("FILE.html")
      ->check(not_empty());
  command
      ->add_option("--detail", options->detail,
                   "Keep every row of this time span (FROM:TO [s], or all) of a table that is too long for the page "
                   "(may be repeated)")
      ->type_name("FROM:TO")
      ->allow_extra_args(false);
  command
      ->add_option("--mcap", options->mcap,
                   "Also write the first run as an MCAP file for Foxglove, Lichtblick and PlotJuggler (needs the "
                   "Python package mcap)")
      ->type_name("FILE.mcap")
      ->check(not_empty());
  command
      ->add_option("--video", options->video,
                   "Also write a video of the page; the suffix (.mp4) selects the format. Needs Chromium and ffmpeg")
      ->type_name("FILE.mp4")
      ->check(not_empty());
  command->add_option("--fps", options->frames_per_second, "Frames per second of the video; default: 15")
      ->check(CLI::Range(1U, 240U));
  command->add_option("--speed", options->video_speed, "Simulated seconds per second of the video; default: 1")
      ->check(positive());
  command->footer(help_footer(
      {"0 the page was written", "1 the page cannot be written: no space, or mebots was built without pages",
       "2 a folder is not the results folder of a run, or a program for the video is missing"},
      {"mebots report results/gate_easy", "mebots report results/slow results/fast --out beside.html",
       "mebots report results/long --detail 120:130",
       "mebots report results/gate_easy --mcap flight.mcap --video flight.mp4"}));
  command->callback([options, &action] { action = [options] { return guarded([&] { report_runs(*options); }); }; });
}

}  // namespace mebots::app
