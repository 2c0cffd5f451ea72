// SPDX-License-Identifier: Apache-2.0
// `mebots sweep` is written in Python (master/python/mebots/exploration): the program becomes the interpreter that runs
// it.
#include "command.hpp"

#include "base/installation.hpp"
#include "mebots/input_error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace mebots::app {
namespace {

using Path = std::filesystem::path;

struct SweepOptions {
  Path study;
  Path out;
  unsigned jobs = 0;
  bool dry_run = false;
  Path status;
  std::vector<Path> reuse;
};

/// Tells in one line what Python lacks: another version of it cannot load the extension, say.
constexpr const char* kStart =
    "import sys\n"
    "try:\n"
    "    from mebots.exploration.command import main\n"
    "except ImportError as error:\n"
    "    print(f'mebots: error: Python {sys.version.split()[0]} at {sys.executable} cannot load the package mebots: "
    "{error}. MEBOTS_PYTHON names another Python', file=sys.stderr)\n"
    "    sys.exit(2)\n"
    "sys.exit(main())\n";

/// The folder that holds the package: of a build beside `bin`, of an installation in `lib/python3.x/site-packages`.
Path package_folder() {
  std::vector<Path> places;
  for (const auto& program : master::program_places("mebots")) {
    const auto root = program.parent_path().parent_path();
    places.push_back(root / "python");
    std::error_code none;
    std::vector<Path> versions;
    for (const auto& entry : std::filesystem::directory_iterator(root / "lib", none)) {
      if (entry.path().filename().string().starts_with("python3")) versions.push_back(entry.path() / "site-packages");
    }
    std::ranges::sort(versions, std::greater<>());
    places.insert(places.end(), versions.begin(), versions.end());
  }
  const auto found = std::ranges::find_if(
      places, [](const Path& place) { return std::filesystem::exists(place / "mebots" / "exploration"); });
  if (found != places.end()) return *found;
  throw InputError(
      ErrorCode::not_offered,
      fmt::format("`mebots sweep` needs the Python package mebots, which is at none of {}: build MEbots with Python "
                  "(python3-dev, pybind11-dev)",
                  fmt::join(master::as_texts(places), ", ")));
}

std::vector<std::string> words_of(const SweepOptions& options, const std::string& python) {
  std::vector<std::string> words = {python, "-c", kStart};
  if (!options.study.empty()) words.push_back(options.study.string());
  if (!options.out.empty()) words.insert(words.end(), {"--out", options.out.string()});
  if (options.jobs > 0) words.insert(words.end(), {"--jobs", std::to_string(options.jobs)});
  if (options.dry_run) words.emplace_back("--dry-run");
  if (!options.status.empty()) words.insert(words.end(), {"--status", options.status.string()});
  for (const auto& folder : options.reuse) words.insert(words.end(), {"--reuse", folder.string()});
  return words;
}

/// Does not return but by an exception.
void become_python(const SweepOptions& options) {
  auto path = package_folder().string();
  if (const char* given = std::getenv("PYTHONPATH"); given != nullptr && *given != '\0')
    path += ":" + std::string(given);
  setenv("PYTHONPATH", path.c_str(), 1);
  const char* named = std::getenv("MEBOTS_PYTHON");
  const std::string python = named != nullptr && *named != '\0' ? named : "python3";
  auto words = words_of(options, python);
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (auto& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execvp(python.c_str(), arguments.data());
  throw InputError(ErrorCode::not_offered,
                   fmt::format("`mebots sweep` needs {}, which cannot be started: {}. Install python3, or name another "
                               "Python by MEBOTS_PYTHON",
                               python, std::strerror(errno)));
}

}  // namespace

void add_sweep(CLI::App& app, Action& action) {
  const auto options = std::make_shared<SweepOptions>();
  auto* command = app.add_subcommand("sweep", "Fly the missions of a study, and answer its question");
  command->add_option("study", options->study, "Study (.json)");
  command
      ->add_option("--out", options->out,
                   "Folder for missions.csv, designs.csv, journal.jsonl and report.html; a study that was interrupted "
                   "goes on there")
      ->check(not_empty());
  command->add_option("--jobs", options->jobs, "Missions at the same time; default: one for each processor")
      ->check(CLI::Range(1U, 1024U));
  command->add_flag("--dry-run", options->dry_run, "Check the study; tell how many missions, how long, how much disk");
  command->add_option("--status", options->status, "Tell how far the study in this folder is; fly nothing")
      ->check(not_empty());
  command
      ->add_option("--reuse", options->reuse,
                   "Take missions that this folder's journal has, instead of flying them (may be repeated)")
      ->allow_extra_args(false)
      ->take_all();
  command->footer(
      help_footer({"0 the study is done", "1 it was interrupted, or missions failed", "2 the input cannot be used"},
                  {"mebots sweep study.json --out results/study --jobs 2",
                   "mebots sweep study.json --out results/study --dry-run", "mebots sweep --status results/study"}));
  command->callback([options, &action] { action = [options] { return guarded([&] { become_python(*options); }); }; });
}

}  // namespace mebots::app
