// SPDX-License-Identifier: Apache-2.0
// `mebots sweep` is written in Python (master/python/mebots/exploration). This program replaces itself by the Python
// interpreter.
#include "command.hpp"
#include "python_words.hpp"

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

Words words_of(const SweepOptions& options) {
  Words words;
  if (!options.study.empty()) words.push_back(options.study.string());
  add_word(words, "--mission", options.mission);
  add_word(words, "--out", options.out);
  if (options.jobs > 0) words.insert(words.end(), {"--jobs", std::to_string(options.jobs)});
  if (options.dry_run) words.emplace_back("--dry-run");
  add_word(words, "--status", options.status);
  for (const auto& folder : options.reuse) add_word(words, "--reuse", folder);
  return words;
}

}  // namespace

void add_sweep(CLI::App& app, Action& action) {
  const auto options = std::make_shared<SweepOptions>();
  auto* command = app.add_subcommand("sweep", "Run a study: many missions, with statistics");
  command->add_option("study", options->study, "Study (.json)")->type_name("FILE.json");
  command
      ->add_option("--mission", options->mission,
                   "Config to use in place of the study's, with the same designs and draws")
      ->type_name("FILE.json")
      ->check(not_empty());
  command
      ->add_option(
          "--out", options->out,
          "Folder for missions.csv, designs.csv, journal.jsonl and report.html; an interrupted study continues there")
      ->type_name("FOLDER")
      ->check(not_empty());
  command->add_option("--jobs", options->jobs, "Number of missions that run in parallel; default: one per processor")
      ->check(CLI::Range(1U, 1024U));
  command->add_flag("--dry-run", options->dry_run, "Check the study; estimate missions, time and disk space");
  command->add_option("--status", options->status, "Show the progress of the study in this folder; run nothing")
      ->type_name("FOLDER")
      ->check(not_empty());
  command
      ->add_option("--reuse", options->reuse,
                   "Reuse the missions in the journal of this folder instead of running them (may be repeated)")
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
