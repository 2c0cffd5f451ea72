// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"

#include "base/installation.hpp"

#include "mebots/error.hpp"

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace mebots::app {
namespace {

/// Writes the page and prints its path. If this fails, prints the reason; the run is valid without a page.
void show_page(const std::filesystem::path& folder) {
  try {
    std::printf("page: %s (open it in a browser)\n", write_report({folder}, {}).c_str());
  } catch (const Error& error) {
    std::printf("no page: %s\n", error.what());
  }
}

/// Runs `mebots run` with a shipped config and the given options, then writes the page.
int demo(std::vector<std::string> options) {
  const auto config = master::own_data("configs") / "gate_easy.json";
  options.insert(options.begin(), {"run", config.string()});
  CLI::App run_app;
  Action run;
  add_run(run_app, run);
  std::vector<std::string> reversed(options.rbegin(), options.rend());  // CLI11 expects reverse order
  try {
    run_app.parse(reversed);
  } catch (const CLI::ParseError& error) {
    print_error(error.what() + std::string(". `mebots run --help` lists its options"));
    return 2;
  }
  const int code = run();
  const auto* command = run_app.get_subcommand("run");
  const auto* out = command->get_option("--out");
  if (code == 0 && command->count("--quiet") == 0) {
    show_page(out->empty() ? default_results(config) : std::filesystem::path(out->as<std::string>()));
  }
  return code;
}

}  // namespace

void add_demo(CLI::App& app, Action& action) {
  auto* command = app.add_subcommand("demo", "Fly the shipped mission: a drone finds a gate and flies through it");
  command->prefix_command();
  command->footer(help_footer({"the exit codes and the options are those of `mebots run`"},
                              {"mebots demo", "mebots demo --out flight --set soc.mission.cruise_speed=0.4"}));
  command->callback([command, &action] { action = [options = command->remaining()] { return demo(options); }; });
}

}  // namespace mebots::app
