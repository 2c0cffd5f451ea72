// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"

#include "base/installation.hpp"

#include <memory>
#include <string>
#include <vector>

namespace mebots::app {
namespace {

/// A demo is `mebots run` of the shipped config, and takes the same options.
int demo(std::vector<std::string> options) {
  options.insert(options.begin(), {"run", (master::own_data("configs") / "gate_easy.json").string()});
  CLI::App run_app;
  Action run;
  add_run(run_app, run);
  std::vector<std::string> reversed(options.rbegin(), options.rend());  // as CLI11 takes them
  try {
    run_app.parse(reversed);
  } catch (const CLI::ParseError& error) {
    print_error(error.what() + std::string(". `mebots run --help` tells what it takes"));
    return 2;
  }
  return run();
}

}  // namespace

void add_demo(CLI::App& app, Action& action) {
  auto* command = app.add_subcommand("demo", "Fly the shipped mission: a drone finds a gate and flies through it");
  command->prefix_command();
  command->footer(help_footer({"those of `mebots run`, whose options it takes"},
                              {"mebots demo", "mebots demo --out flight --set soc.mission.cruise_speed=0.4"}));
  command->callback([command, &action] { action = [options = command->remaining()] { return demo(options); }; });
}

}  // namespace mebots::app
