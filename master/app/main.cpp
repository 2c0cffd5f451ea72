// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"

#include "command_line/command.hpp"
#include "io/config/command_line.hpp"
#include "mebots/nearest_names.hpp"
#include "mebots/version.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <string>
#include <vector>

namespace {

using namespace mebots::app;

constexpr AddCommand kCommands[] = {
    &add_run,     &add_resume,   &add_sweep,  &add_replay, &add_identify, &add_new_cell,      &add_link,
    &add_deploy,  &add_demo,     &add_report, &add_info,   &add_check,    &add_fmu_platforms, &add_test,
    &add_convert, &add_validate, &add_schema, &add_units,  &add_new_fmu,  &add_new_firmware,  &add_new_sensor};

/// Opens closed standard streams (`>&-`) as /dev/null. Otherwise, a file could get the descriptor of a standard stream
/// and receive its output.
void open_standard_streams() {
  for (int stream = 0; stream <= 2; ++stream) {
    if (fcntl(stream, F_GETFD) == -1 && open("/dev/null", O_RDWR) != stream) return;
  }
}

std::vector<std::string> names_of_commands(const CLI::App& app) {
  std::vector<std::string> names;
  for (const auto* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
  }
  return names;
}

std::vector<std::string> names_of_options(const CLI::App& command) {
  std::vector<std::string> names;
  for (const auto* option : command.get_options()) {
    for (const auto& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// Returns one line about an error in the command line and its remedy.
std::string complaint(CLI::App& app, const CLI::ParseError& error) {
  const auto given = app.get_subcommands();
  if (given.empty()) {
    const auto strange = app.remaining();
    if (!strange.empty() && !strange.front().starts_with('-')) {
      return "there is no command '" + strange.front() + "'. " +
             mebots::suggest(strange.front(), names_of_commands(app));
    }
    if (!strange.empty()) {
      return "there is no option '" + strange.front() + "' before the command. " +
             mebots::suggest(strange.front(), names_of_options(app));
    }
    return "a command is missing. `mebots --help` lists them";
  }
  auto& command = *given.front();
  const auto help = ". `mebots " + command.get_name() + " --help` lists its options";
  const auto strange = app.remaining(true);
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr && !strange.empty()) {
    const auto& word = strange.front();
    if (!word.starts_with('-')) return "'" + word + "' is one argument too many" + help;
    return "there is no option '" + word.substr(0, word.find('=')) + "' of '" + command.get_name() + "'. " +
           mebots::suggest(word.substr(0, word.find('=')), names_of_options(command));
  }
  return std::string(error.what()) + help;
}

}  // namespace

int main(int argument_count, char** arguments) {
  open_standard_streams();
  std::signal(SIGPIPE, SIG_IGN);                            // a closed output pipe must not end the run
  pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, nullptr);  // prevents FMUs from cancelling this thread
  std::signal(SIGXFSZ, SIG_IGN);                            // writes beyond the file size limit then return an error
  CLI::App app{"MEbots: co-simulation of FMI 1.0, 2.0 and 3.0 FMUs"};
  app.name("mebots");
  app.set_version_flag("--version", "mebots " + std::string(mebots::version()));
  app.require_subcommand(1);
  app.footer("`mebots COMMAND --help` lists a command's options, exit codes and examples.");
  Action action;
  for (const auto add : kCommands) add(app, action);
  const std::string version(mebots::version());
  if (const auto code = mebots::command_line::handle_hidden_options(app, version, argument_count, arguments))
    return *code;
  try {
    const std::vector<std::string> given(arguments + std::min(argument_count, 1), arguments + argument_count);
    const auto words = mebots::master::with_each_set(given);
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));  // CLI11 expects reverse order
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // for --help and --version
    print_error(complaint(app, error));
    return 2;
  }
  try {
    return action();
  } catch (const std::exception& error) {
    print_error(error.what());
    return 1;
  }
}
