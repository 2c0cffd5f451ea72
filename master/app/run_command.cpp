// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"
#include "console.hpp"
#include "end_lines.hpp"
#include "junit_report.hpp"
#include "live_view.hpp"
#include "progress.hpp"

#include "base/signal_guard.hpp"
#include "base/time.hpp"
#include "io/config/command_line.hpp"
#include "io/config/load_system.hpp"
#include "run/draws.hpp"
#include "run/run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <memory>

namespace mebots::app {
namespace {

using master::Run;

constexpr int kSuccess = 0;
constexpr int kFailed = 1;
constexpr int kBadInput = 2;

/// The options of `mebots run`. `run` contains the options that need no parsing; the others are texts.
struct TypedOptions {
  std::filesystem::path config;
  RunOptions run;
  std::vector<std::string> sets;    ///< INSTANCE.VARIABLE=VALUE
  std::vector<std::string> record;  ///< name patterns
  std::optional<std::string> stop_time;
  std::optional<std::string> step;
  std::optional<std::string> checkpoint_every;
  std::optional<std::string> uncertainty;  ///< "calibration" or "none"
};

/// The options of both `mebots run` and `mebots resume`.
struct ReportOptions {
  std::vector<std::string> expect;  ///< accepted outcomes
  std::filesystem::path junit;      ///< JUnit file to write; empty: none
  bool quiet = false;
  bool verbose = false;
  bool dry_run = false;  ///< only for `mebots run`
  LiveViewOptions live;
};

RunOptions options_of(const TypedOptions& typed) {
  auto options = typed.run;
  if (options.out.empty()) options.out = default_results(typed.config);
  for (const auto& set : typed.sets) options.settings.push_back(master::read_set(set));
  if (!typed.record.empty()) options.record = typed.record;
  if (typed.stop_time) options.stop_time_s = master::to_seconds(master::read_time("--stop-time", *typed.stop_time));
  if (typed.step) options.step_s = master::read_step("--step", *typed.step);
  if (typed.uncertainty) options.draws_calibration = *typed.uncertainty == "calibration";
  if (typed.checkpoint_every) {
    options.checkpoint_every_s =
        master::to_seconds(master::read_duration("--checkpoint-every", *typed.checkpoint_every));
  }
  return options;
}

/// Prints an error if the run did not end as expected. Returns the exit code.
int exit_code(const Run& run, const ReportOptions& options, Console& console) {
  if (run.report().end_reason == EndReason::interrupted) return kFailed;
  const auto why = why_unexpected(run, options.expect);
  if (why.empty()) return kSuccess;
  console.error(why);
  return kFailed;
}

void show_end(const Run& run, const ReportOptions& options, Console& console) {
  for (const auto& loss : run.losses()) {
    console.warning(fmt::format("'{}' was lost at {} s; the others continued without it", loss.name,
                                master::to_seconds(*loss.at_ns)));
  }
  for (const auto& line : end_lines(run, options.verbose)) console.line(line);
  if (const auto* steps = run.step_statistics()) console.line(step_control_line(run.resolved(), *steps));
  for (const auto& line : solvers_table(run.solvers())) console.line(line);
  if (run.options().statistics) {
    for (const auto& line : statistics_table(run.statistics(), run.report().wall.simulating_s())) console.line(line);
  }
  const bool interrupted = run.report().end_reason == EndReason::interrupted;
  const bool checkpoint = run.files() != nullptr && run.files()->kept() && run.files()->has_checkpoint();
  if (interrupted && checkpoint) {
    console.line(fmt::format("resume with: mebots resume {}", shell_word(run.options().out.string())));
  }
}

/// Performs drawn runs with random calibration parameters and adds the interval of each number to the summary of `run`.
void fly_draws(Run& run, Console& console) {
  master::DrawnFlights draws(run);
  const auto progress = [&console](int flight) {
    console.redraw(fmt::format("uncertainty: flight {} of {}", flight, master::DrawnFlights::kFlights));
  };
  const bool done = draws.fly(progress);
  console.redraw("");
  for (const auto& text : draws.without_effect()) console.warning(text);
  if (done) {
    run.report_uncertainty(draws.json());
  } else {
    console.warning("uncertainty: interrupted, so the summary has no intervals");
  }
}

/// Performs the run that `open` creates. Returns the exit code.
int execute(const std::function<std::unique_ptr<Run>()>& open, const ReportOptions& options) {
  Console console(options.quiet);
  try {
    require_folder_of(options.junit);
  } catch (const InputError& error) {
    console.error(fmt::format("--junit {}", error.what()));
    return kBadInput;
  }
  std::unique_ptr<Run> run;
  int code = kFailed;
  std::string error_text;
  try {
    run = open();
    run->free_at_end();
    check_expected(run->system(), options.expect);
    const master::SignalGuard guard(run->interrupt_flag());
    Progress progress(console, run->system().start_time_ns, run->system().stop_time_ns);
    run->listen([&](const Message& message) { console.message(message); });
    run->add(progress);
    if (options.dry_run) {
      run->start();
      for (const auto& line : start_lines(*run)) console.line(line);
      return kSuccess;
    }
    const auto view = options.live.is_on() ? LiveView::make(*run, options.live, console) : nullptr;
    if (view) {
      view->run();
    } else {
      run->start();
      run->run();
    }
    if (master::wants_draws(*run)) fly_draws(*run, console);
    show_end(*run, options, console);
    code = exit_code(*run, options, console);
    if (view) view->end(console);
  } catch (const InputError& error) {
    error_text = error.what();
    code = kBadInput;
  } catch (const std::exception& error) {  // such as out of memory; the results so far are still written
    error_text = error.what();
  }
  console.redraw("");
  if (!error_text.empty()) console.error(error_text);
  if (options.junit.empty()) return code;
  try {
    write_junit(options.junit, run.get(), options.expect, error_text);
  } catch (const Error& error) {
    console.error(error.what());
    if (code == kSuccess) code = kFailed;
  }
  return code;
}

void add_report_options(CLI::App& command, ReportOptions& options) {
  command
      .add_option("--expect", options.expect,
                  "Exit with 1 unless the outcome is this one (may be repeated to accept several)")
      ->type_name("OUTCOME")
      ->allow_extra_args(false)
      ->take_all();
  command.add_option("--junit", options.junit, "Write the run as one test case of a JUnit file")
      ->type_name("FILE.xml")
      ->check(not_empty());
  command.add_flag("--quiet", options.quiet, "Show warnings and errors only");
  command.add_flag("--verbose", options.verbose, "Show all values of the summary at the end, one per line");
}

const std::vector<std::string> kExitCodes = {"0 the simulation ran to its end (with the expected outcome)",
                                             "1 the simulation failed, was interrupted, or had another outcome than "
                                             "expected, or an FMU crashed when it was freed",
                                             "2 the input cannot be used: command line, config, FMU, results folder"};

}  // namespace

void add_run(CLI::App& app, Action& action) {
  const auto run = std::make_shared<TypedOptions>();
  const auto report = std::make_shared<ReportOptions>();
  auto* command =
      app.add_subcommand("run", "Run the ensemble of FMUs that a config or an SSP describes, or an FMU alone");
  command
      ->add_option("config", run->config,
                   "Config (.json), FMU (.fmu), SSP (.ssp, .ssd or its folder) or OspSystemStructure.xml")
      ->type_name("FILE")
      ->required();
  command
      ->add_option("--out", run->run.out,
                   "Folder for results.csv, summary.json and log.txt; default: results/<name of the config>")
      ->type_name("FOLDER")
      ->check(not_empty());
  command
      ->add_option(
          "--set", run->sets,
          "Set parameters or start values; in the name, * and ? select several variables. More assignments may follow, "
          "or the option may be repeated")
      ->type_name("INSTANCE.VARIABLE=VALUE ...")
      ->allow_extra_args(false)
      ->take_all();
  command
      ->add_option("--scenario", run->run.scenarios,
                   "Overrides of variables from a file, after those of the config (may be repeated)")
      ->type_name("FILE.json")
      ->allow_extra_args(false)
      ->take_all();
  command
      ->add_option("--inputs", run->run.inputs,
                   "Signals over time for free inputs, from a CSV file whose columns are named after them (may be "
                   "repeated)")
      ->type_name("FILE.csv")
      ->allow_extra_args(false)
      ->take_all();
  command
      ->add_option("--record", run->record,
                   "Record the variables that match this pattern (* and ?), in place of the config's choice (may be "
                   "repeated)")
      ->type_name("PATTERN")
      ->allow_extra_args(false)
      ->take_all();
  command->add_option("--stop-time", run->stop_time, "End of the simulation [s], instead of the config's")
      ->type_name("SECONDS");
  command
      ->add_option("--step", run->step,
                   "Communication step [s] or ratio such as 1/60, for an FMU alone, or an SSP that specifies none")
      ->type_name("SECONDS");
  command->add_flag("--statistics", run->run.statistics,
                    "Show calls, time and slowest step of every instance, and write them to summary.json");
  command
      ->add_option("--checkpoint-every", run->checkpoint_every,
                   "Write a checkpoint at t = 0 and then at this interval of simulated time [s]")
      ->type_name("SECONDS");
  command
      ->add_option("--uncertainty", run->uncertainty,
                   "calibration: run 19 more flights with drawn parameters and report intervals; none: do not")
      ->type_name("KIND")
      ->check(CLI::IsMember({"calibration", "none"}));
  command->add_flag("--dry-run", report->dry_run,
                    "Check everything up to t = 0, print the instances and the numbers of connections and columns, and "
                    "write nothing");
  command->add_flag("--isolate", run->run.isolate, "Run every instance in a separate process");
  add_live_options(*command, report->live);
  add_report_options(*command, *report);
  command->footer(
      help_footer(kExitCodes, {"mebots run configs/gate_easy.json --out results/fast --set soc.core.clock=150e6",
                               "mebots run configs/gate_easy.json --expect passed --junit gate.xml",
                               "mebots run configs/gate_easy.json --isolate --checkpoint-every 5",
                               "mebots run bouncing_ball.fmu --step 0.01 --stop-time 3 --set e=0.8",
                               "mebots run motor.fmu --inputs drive.csv"}));
  command->callback([run, report, &action] {
    action = [run, report] {
      const auto open = [&] {
        auto options = options_of(*run);
        options.in_memory = report->live.is_on();
        if (report->dry_run) options.out.clear();
        return std::make_unique<Run>(run->config, options);
      };
      return execute(open, *report);
    };
  });
}

void add_resume(CLI::App& app, Action& action) {
  const auto folder = std::make_shared<std::filesystem::path>();
  const auto report = std::make_shared<ReportOptions>();
  auto* command = app.add_subcommand("resume", "Resume a run from its last checkpoint");
  command->add_option("folder", *folder, "The results folder of the run")->type_name("FOLDER")->required();
  add_live_options(*command, report->live);
  add_report_options(*command, *report);
  command->footer(help_footer(kExitCodes, {"mebots resume results/gate_easy"}));
  command->callback([folder, report, &action] {
    action = [folder, report] { return execute([&] { return Run::resume(*folder, report->live.is_on()); }, *report); };
  });
}

}  // namespace mebots::app
