// SPDX-License-Identifier: Apache-2.0
#include "check_command.hpp"
#include "convert_command.hpp"
#include "info_command.hpp"
#include "new_fmu_command.hpp"
#include "resume_command.hpp"
#include "run_command.hpp"

#include "base/nearest_names.hpp"
#include "config/config_schema.hpp"

#include <CLI/CLI.hpp>

#include <fcntl.h>

#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

namespace {

const CLI::Validator kPositive(
    [](std::string& text) -> std::string {
      double number = 0;
      if (CLI::detail::lexical_cast(text, number) && std::isfinite(number) && number > 0) return "";
      return text + " is no number greater than 0";
    },
    "POSITIVE");

const CLI::Validator kNotEmpty([](std::string& text) -> std::string { return text.empty() ? "the name is empty" : ""; },
                               "");

/// Where a stream is closed (`>&-`), the next file to be opened would get its number, and what is printed.
void open_standard_streams() {
  for (int stream = 0; stream <= 2; ++stream) {
    if (fcntl(stream, F_GETFD) == -1 && open("/dev/null", O_RDWR) != stream) return;
  }
}

}  // namespace

int main(int argument_count, char** arguments) {
  open_standard_streams();
  CLI::App app{"MEbots: co-simulation of FMI 2.0 FMUs"};
  app.name("mebots");
  app.set_version_flag("--version", MEBOTS_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 the simulation ran to its end, 1 it failed or was interrupted, 2 the input cannot be used.");

  mebots::app::RunOptions run;
  auto* run_app = app.add_subcommand("run", "Run the ensemble of FMUs that a config or an SSP describes");
  run_app->add_option("config", run.config, "Config (.json) or SSP 1.0 (.ssp)")->required();
  run_app
      ->add_option("--out", run.out,
                   "Folder for results.csv, summary.json and log.txt; default: results/<name of the config>")
      ->check(kNotEmpty);
  run_app->add_option("--set", run.sets, "Give a parameter or a start value: INSTANCE.VARIABLE=VALUE (may be repeated)")
      ->allow_extra_args(false)
      ->take_all();
  run_app
      ->add_option("--scenario", run.scenarios,
                   "Overrides of variables from a file, after those of the config (may be repeated)")
      ->allow_extra_args(false)
      ->take_all();
  run_app->add_option("--stop-time", run.stop_time_s, "End of the simulation [s], instead of the config's");
  run_app->add_option("--step", run.step_s, "Communication step [s], for an SSP that does not say it");
  run_app->add_flag("--statistics", run.statistics,
                    "Show calls, time and slowest step of every instance, and write them to summary.json");
  run_app->add_option("--checkpoint-every", run.checkpoint_every_s,
                      "Write a checkpoint at t = 0 and after every so many seconds of simulated time");
  run_app->add_flag("--isolate", run.isolate, "Run every instance in a process of its own");
  run_app->add_flag("--quiet", run.quiet, "Show warnings and errors only");

  std::filesystem::path results;
  bool quiet_resume = false;
  auto* resume_app = app.add_subcommand("resume", "Go on with a run from its last checkpoint");
  resume_app->add_option("folder", results, "The results folder of the run")->required();
  resume_app->add_flag("--quiet", quiet_resume, "Show warnings and errors only");

  std::filesystem::path file;
  auto* info_app = app.add_subcommand("info", "Show what an FMU, a config or an SSP says of itself");
  info_app->add_option("file", file, "FMU (.fmu), config (.json) or SSP (.ssp)")->required();

  std::filesystem::path from;
  std::filesystem::path to;
  auto* convert_app = app.add_subcommand("convert", "Turn a config into an SSP 1.0, or an SSP into a config");
  convert_app->add_option("from", from, "Config (.json) or SSP (.ssp)")->required();
  convert_app->add_option("to", to, "SSP (.ssp) or config (.json) to write")->required();

  auto* schema_app = app.add_subcommand("schema", "Print the JSON schema of a config");

  mebots::app::CheckOptions check;
  auto* check_app = app.add_subcommand(
      "check", "Look for mistakes in an FMU, from archive to behaviour (exit code 0 clean, 1 findings, 2 unreadable)");
  check_app->add_option("fmu", check.fmu, "FMU file")->required();
  check_app->add_flag("--json", check.json, "Print a report for machines");
  check_app->add_flag("--files-only", check.files_only, "Run nothing of the FMU's code");
  check_app
      ->add_option("--half-step-tolerance", check.half_step_tolerance,
                   "What two half steps may differ from one by, relative to an output's largest magnitude")
      ->check(kPositive);
  check_app->add_option("--deadline", check.deadline_s, "Wall time for each experiment with the FMU [s]")
      ->check(kPositive);

  std::filesystem::path description;
  std::filesystem::path folder;
  auto* new_fmu_app =
      app.add_subcommand("new-fmu", "Write the folder of a new FMU, which builds, from its description");
  new_fmu_app->add_option("description", description, "description.json with the FMU's variables")->required();
  new_fmu_app->add_option("--out", folder, "Folder to make; default: the FMU's name")->check(kNotEmpty);

  try {
    app.parse(argument_count, arguments);
  } catch (const CLI::ParseError& error) {
    const auto strange = app.remaining();
    if (app.get_subcommands().empty() && !strange.empty() && !strange.front().starts_with('-')) {
      std::vector<std::string> known;
      for (const auto* command : app.get_subcommands({})) known.push_back(command->get_name());
      std::fprintf(stderr, "mebots: error: there is no command '%s'. %s\n", strange.front().c_str(),
                   mebots::master::suggest(strange.front(), known).c_str());
      return 2;
    }
    const bool asked_for_text = error.get_exit_code() == 0;
    app.exit(error);
    return asked_for_text ? 0 : 2;
  }
  try {
    if (run_app->parsed()) return mebots::app::run_command(run);
    if (info_app->parsed()) return mebots::app::info_command(file);
    if (check_app->parsed()) return mebots::app::check_command(check);
    if (resume_app->parsed()) return mebots::app::resume_command(results, quiet_resume);
    if (new_fmu_app->parsed()) return mebots::app::new_fmu_command(description, folder);
    if (convert_app->parsed()) return mebots::app::convert_command(from, to);
    if (schema_app->parsed()) {
      const auto schema = mebots::master::config_schema();
      return std::fwrite(schema.data(), 1, schema.size(), stdout) == schema.size() ? 0 : 1;
    }
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mebots: error: %s\n", error.what());
    return 1;
  }
}
