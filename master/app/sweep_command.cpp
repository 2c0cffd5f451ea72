// SPDX-License-Identifier: Apache-2.0
// `mebots sweep` is written in Python (master/python/mebots/exploration). The program is replaced by the interpreter
// that runs it.
#include "command.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace mebots::app {
namespace {

using Path = std::filesystem::path;

struct SweepOptions {
  Path study;
  Path mission;
  Path out;
  unsigned jobs = 0;
  bool dry_run = false;
  Path status;
  std::vector<Path> reuse;
};

std::vector<std::string> words_of(const SweepOptions& options) {
  std::vector<std::string> words;
  if (!options.study.empty()) words.push_back(options.study.string());
  if (!options.mission.empty()) words.insert(words.end(), {"--mission", options.mission.string()});
  if (!options.out.empty()) words.insert(words.end(), {"--out", options.out.string()});
  if (options.jobs > 0) words.insert(words.end(), {"--jobs", std::to_string(options.jobs)});
  if (options.dry_run) words.emplace_back("--dry-run");
  if (!options.status.empty()) words.insert(words.end(), {"--status", options.status.string()});
  for (const auto& folder : options.reuse) words.insert(words.end(), {"--reuse", folder.string()});
  return words;
}

}  // namespace

void add_sweep(CLI::App& app, Action& action) {
  const auto options = std::make_shared<SweepOptions>();
  auto* command = app.add_subcommand("sweep", "Fly the missions of a study, and answer its question");
  command->add_option("study", options->study, "Study (.json)")->type_name("FILE.json");
  command
      ->add_option("--mission", options->mission,
                   "Config that is flown in place of the study's: the same designs and draws on another mission")
      ->type_name("FILE.json")
      ->check(not_empty());
  command
      ->add_option("--out", options->out,
                   "Folder for missions.csv, designs.csv, journal.jsonl and report.html; a study that was interrupted "
                   "goes on there")
      ->type_name("FOLDER")
      ->check(not_empty());
  command->add_option("--jobs", options->jobs, "Missions at the same time; default: one for each processor")
      ->check(CLI::Range(1U, 1024U));
  command->add_flag("--dry-run", options->dry_run, "Check the study; estimate missions, time and disk space");
  command->add_option("--status", options->status, "Show how far the study in this folder is; fly nothing")
      ->type_name("FOLDER")
      ->check(not_empty());
  command
      ->add_option("--reuse", options->reuse,
                   "Take missions that this folder's journal has, instead of flying them (may be repeated)")
      ->type_name("FOLDER")
      ->allow_extra_args(false)
      ->take_all();
  command->footer(
      help_footer({"0 the study is done", "1 it was interrupted, or missions failed",
                   "2 the input cannot be used, or an objective has no value in any mission"},
                  {"mebots sweep study.json --out results/study --jobs 2",
                   "mebots sweep study.json --mission configs/gate_hard_gap8.json --out results/gap8",
                   "mebots sweep study.json --out results/study --dry-run", "mebots sweep --status results/study"}));
  command->callback([options, &action] {
    action = [options] {
      return guarded([&] { become_python("mebots sweep", "mebots.exploration.command", words_of(*options)); });
    };
  });
}

}  // namespace mebots::app
