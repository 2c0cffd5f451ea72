// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"

#include "base/signal_guard.hpp"
#include "check_fmu.hpp"
#include "child.hpp"
#include "mebots/error.hpp"

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>

namespace mebots::app {
namespace {

struct CheckOptions {
  std::filesystem::path fmu;
  bool json = false;
  bool files_only = false;
  double half_step_tolerance = 1e-3;
  double deadline_s = 30;
  std::string level = "standard";
};

int check_command(const CheckOptions& options) {
  std::string text;
  bool clean = false;
  std::atomic<bool> given_up = false;
  try {
    // After an interrupt, deletes the unpacked FMU before the signal ends this process.
    const master::SignalGuard guard(given_up, master::SignalGuard::Afterwards::raise);
    check::Options how;
    how.half_step_tolerance = options.half_step_tolerance;
    how.deadline_s = options.deadline_s;
    how.level = check::level_named(options.level);
    how.given_up = &given_up;
    how.run = !options.files_only;
    const auto report = check::check_fmu(options.fmu, how);
    text = options.json ? check::to_json(report) : check::to_text(report);
    clean = report.clean();
  } catch (const check::Interrupted& error) {
    print_error(error.what());
    return 1;
  } catch (const Error& error) {
    print_error(error.what());
    return 2;
  }
  const int code = guarded([&] { print_product(text); });
  return code != 0 || clean ? code : 1;
}

}  // namespace

void add_check(CLI::App& app, Action& action) {
  const auto options = std::make_shared<CheckOptions>();
  auto* command = app.add_subcommand("check", "Check an FMU: archive, description, library and behaviour");
  command->add_option("fmu", options->fmu, "FMU file")->type_name("FILE.fmu")->required();
  command
      ->add_option("--level", options->level,
                   "interoperable: problems that stop other tools; standard: also violations of FMI; pedantic: also "
                   "deviations from good practice")
      ->check(CLI::IsMember(check::level_names()))
      ->option_text("LEVEL [standard]");
  command->add_flag("--json", options->json, "Print the report as JSON");
  command->add_flag("--files-only", options->files_only, "Do not run the FMU's code");
  command
      ->add_option("--half-step-tolerance", options->half_step_tolerance,
                   "Allowed difference between one step and two half steps, relative to an output's largest magnitude")
      ->check(positive());
  command->add_option("--deadline", options->deadline_s, "Longest time that an experiment may compute or sleep [s]")
      ->check(positive());
  command->footer(
      help_footer({"0 clean", "1 findings, or standard output is closed or full", "2 the file cannot be read"},
                  {"mebots check yours.fmu", "mebots check yours.fmu --level pedantic --json > report.json"}));
  command->callback([options, &action] { action = [options] { return check_command(*options); }; });
}

}  // namespace mebots::app
