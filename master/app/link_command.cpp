// SPDX-License-Identifier: Apache-2.0
// `mebots link` is written in Python (master/python/mebots/link). This program replaces itself by the Python
// interpreter.
#include "command.hpp"
#include "python_words.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mebots::app {
namespace {

using Path = std::filesystem::path;

struct LinkOptions {
  Path config;
  Path out;
  std::vector<std::string> set;
  std::optional<unsigned> drones;
  std::optional<double> spacing_m;
  std::string decks;
  std::optional<double> stop_time_s;
  std::string host;
  std::optional<unsigned> port;
  std::optional<double> idle_s;
  Path replay;
};

Words words_of(const LinkOptions& options) {
  Words words = {options.config.string()};
  // A replay has no default folder, because it must not overwrite the results of the run that it repeats.
  const auto out = options.out.empty() && options.replay.empty() ? default_results(options.config) : options.out;
  add_word(words, "--out", out);
  add_number(words, "--drones", options.drones);
  add_number(words, "--spacing", options.spacing_m);
  add_word(words, "--decks", options.decks);
  add_number(words, "--stop-time", options.stop_time_s);
  add_word(words, "--host", options.host);
  add_number(words, "--port", options.port);
  add_number(words, "--idle", options.idle_s);
  add_word(words, "--replay", options.replay);
  for (const auto& assignment : options.set) words.push_back("--set=" + assignment);
  return words;
}

void add_options(CLI::App& command, LinkOptions& options) {
  command
      .add_option("config", options.config,
                  "Config with an fmu_world of one or several drones, and motors and a battery for each drone")
      ->type_name("FILE.json")
      ->required();
  command
      .add_option("--out", options.out,
                  "Folder for results and for the recording link.jsonl; default: results/<name of the config>, with "
                  "--replay none")
      ->type_name("FOLDER")
      ->check(not_empty());
  command.add_option("--set", options.set, "Replace parameters or start values of the config")
      ->type_name("INSTANCE.VARIABLE=VALUE");
  command
      .add_option("--drones", options.drones,
                  "Number of runs of the config, each with its own world and port; default: 1")
      ->check(CLI::Range(1U, 100U));
  command.add_option("--spacing", options.spacing_m,
                     "Distance between the starts of these runs along y [m]; default: 1");
  command.add_option("--decks", options.decks, "Decks that the drones report, separated by commas; default: bcFlow2")
      ->type_name("NAMES");
  command.add_option("--stop-time", options.stop_time_s, "End of the run [s], in place of the config's")
      ->check(positive());
  command.add_option("--host", options.host, "Address to listen on; default: 127.0.0.1")->check(not_empty());
  command.add_option("--port", options.port, "Port of the first drone; each further one has the next; default: 19850")
      ->check(CLI::Range(1U, 65535U));
  command
      .add_option("--idle", options.idle_s,
                  "End after this time [s] without a packet; a connected cflib sends ten a second")
      ->check(positive());
  command.add_option("--replay", options.replay, "Repeat the recorded run without its script, as fast as possible")
      ->type_name("link.jsonl")
      ->check(not_empty());
}

}  // namespace

void add_link(CLI::App& app, Action& action) {
  const auto options = std::make_shared<LinkOptions>();
  auto* command = app.add_subcommand("link", "Let scripts for a Crazyflie (cflib, CRTP over UDP) fly simulated drones");
  add_options(*command, *options);
  command->footer(help_footer(
      {"0 the run has ended, or Ctrl-C ended it",
       "1 a model failed, a file could not be written, or a replay gave other bits than the recorded run",
       "2 the input cannot be used"},
      {"mebots link configs/link.json --out results/link", "mebots link configs/link.json --drones 2 --idle 5",
       "mebots link configs/link_4.json", "mebots link configs/link.json --replay results/link/link.jsonl"}));
  command->callback([options, &action] {
    action = [options] {
      return guarded([&] { become_python("mebots link", "mebots.link.command", words_of(*options)); });
    };
  });
}

}  // namespace mebots::app
