// SPDX-License-Identifier: Apache-2.0
#include "info_command.hpp"
#include "run_command.hpp"

#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>

int main(int argument_count, char** arguments) {
  CLI::App app{"MEbots: co-simulation of FMI 2.0 FMUs"};
  app.name("mebots");
  app.set_version_flag("--version", MEBOTS_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 the simulation ran to its end, 1 it failed or was interrupted, 2 the input cannot be used.");

  mebots::app::RunOptions run;
  auto* run_app = app.add_subcommand("run", "Run the ensemble of FMUs that a config file describes");
  run_app->add_option("config", run.config, "Config file (JSON)")->required();
  run_app->add_option("--out", run.out,
                      "Folder for results.csv, summary.json and log.txt; default: results/<name of the config>");
  run_app->add_option("--set", run.sets, "Give a parameter or a start value: INSTANCE.VARIABLE=VALUE (may be repeated)")
      ->allow_extra_args(false)
      ->take_all();
  run_app->add_option("--stop-time", run.stop_time_s, "End of the simulation [s], instead of the config's");
  run_app->add_flag("--statistics", run.statistics,
                    "Show calls, time and slowest step of every instance, and write them to summary.json");
  run_app->add_flag("--quiet", run.quiet, "Show warnings and errors only");

  std::filesystem::path fmu;
  auto* info_app = app.add_subcommand("info", "Show what an FMU says of itself");
  info_app->add_option("fmu", fmu, "FMU file")->required();

  try {
    app.parse(argument_count, arguments);
  } catch (const CLI::ParseError& error) {
    const bool asked_for_text = error.get_exit_code() == 0;
    app.exit(error);
    return asked_for_text ? 0 : 2;
  }
  try {
    return run_app->parsed() ? mebots::app::run_command(run) : mebots::app::info_command(fmu);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mebots: error: %s\n", error.what());
    return 1;
  }
}
