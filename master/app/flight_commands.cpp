// SPDX-License-Identifier: Apache-2.0
// `mebots replay` is written in Python (master/python/mebots/flight): the program becomes the interpreter that runs it.
#include "command.hpp"
#include "python_program.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mebots::app {
namespace {

using Path = std::filesystem::path;
using Words = std::vector<std::string>;

void add_word(Words& words, const std::string& option, const Path& value) {
  if (!value.empty()) words.insert(words.end(), {option, value.string()});
}

void add_number(Words& words, const std::string& option, const std::optional<double>& value) {
  if (value) words.insert(words.end(), {option, fmt::format("{}", *value)});
}

struct ReplayOptions {
  Path log;
  Path airframe;
  Path out;
  Path mapping;
  std::string decks;
  std::optional<double> mass_kg;
  std::optional<double> charge;
  std::optional<double> window_s;
  bool hover = false;
};

Words words_of(const ReplayOptions& options) {
  Words words = {"replay", options.log.string()};
  add_word(words, "--airframe", options.airframe);
  add_word(words, "--out", options.out);
  add_word(words, "--mapping", options.mapping);
  add_word(words, "--decks", options.decks);
  add_number(words, "--mass", options.mass_kg);
  add_number(words, "--charge", options.charge);
  add_number(words, "--window", options.window_s);
  if (options.hover) words.emplace_back("--hover");
  return words;
}

}  // namespace

void add_replay(CLI::App& app, Action& action) {
  const auto options = std::make_shared<ReplayOptions>();
  auto* command = app.add_subcommand(
      "replay", "Fly the commands of a recorded flight, and compare the models with what was measured");
  command->add_option("log", options->log, "Log: Crazyflie uSD, ULog or CSV")->type_name("FILE")->required();
  command->add_option("--airframe", options->airframe, "Rotor, cell, mass and decks of the drone")
      ->type_name("FILE.json")
      ->required();
  command
      ->add_option("--out", options->out,
                   "Folder for replay.html, errors.csv, replay.json, traces.csv and mission.json")
      ->type_name("FOLDER")
      ->required();
  command->add_option("--mapping", options->mapping, "Which column of the log is which signal; needed for CSV")
      ->type_name("FILE.json")
      ->check(not_empty());
  command->add_option("--decks", options->decks, "Decks that the drone carried, in place of the airframe's: NAME,NAME")
      ->type_name("NAMES");
  command->add_option("--mass", options->mass_kg, "Mass of the whole drone [kg], in place of the airframe's")
      ->check(positive());
  command
      ->add_option("--charge", options->charge,
                   "State of charge at the start, up to 1; default: the one with which the first voltages agree")
      ->check(positive());
  command->add_option("--window", options->window_s, "Length of the windows of the momentum balance [s]; default: 1")
      ->check(positive());
  command->add_flag("--hover", options->hover,
                    "The log has no motion, and the drone hovered: compare thrust with its weight");
  command->footer(
      help_footer({"0 replayed", "1 a model or the disk failed", "2 the input cannot be used"},
                  {"mebots replay log00 --airframe configs/airframes/crazyflie_21.json --mass 0.0347 --out replay",
                   "mebots replay flight.csv --mapping columns.json --airframe my_drone.json --out replay"}));
  command->callback([options, &action] {
    action = [options] {
      return guarded([&] { become_python("mebots replay", "mebots.flight.command", words_of(*options)); });
    };
  });
}

}  // namespace mebots::app
