// SPDX-License-Identifier: Apache-2.0
// `mebots replay`, `mebots identify` and `mebots new-cell` are written in Python (master/python/mebots/flight). This
// program replaces itself by the Python interpreter.
#include "command.hpp"
#include "python_words.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mebots::app {
namespace {

using Path = std::filesystem::path;

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

struct IdentifyOptions {
  std::vector<Path> logs;
  Path airframe;
  Path out;
  std::string fit;
  Path mapping;
  std::string decks;
  std::optional<double> mass_kg;
  bool hover = false;
};

Words words_of(const IdentifyOptions& options) {
  Words words = {"identify"};
  for (const auto& log : options.logs) words.push_back(log.string());
  add_word(words, "--airframe", options.airframe);
  add_word(words, "--out", options.out);
  add_word(words, "--fit", options.fit);
  add_word(words, "--mapping", options.mapping);
  add_word(words, "--decks", options.decks);
  add_number(words, "--mass", options.mass_kg);
  if (options.hover) words.emplace_back("--hover");
  return words;
}

struct NewCellOptions {
  Path out;
  std::string name;
  std::optional<double> capacity_mah;
  std::optional<double> mass_g;
  std::optional<double> c_rate;
  std::optional<double> resistance_ohm;
  Path discharge;
  Path mapping;
};

Words words_of(const NewCellOptions& options) {
  Words words = {"new-cell", options.out.string()};
  add_word(words, "--name", options.name);
  add_number(words, "--capacity", options.capacity_mah);
  add_number(words, "--mass", options.mass_g);
  add_number(words, "--c-rate", options.c_rate);
  add_number(words, "--resistance", options.resistance_ohm);
  add_word(words, "--discharge", options.discharge);
  add_word(words, "--mapping", options.mapping);
  return words;
}

}  // namespace

void add_replay(CLI::App& app, Action& action) {
  const auto options = std::make_shared<ReplayOptions>();
  auto* command = app.add_subcommand(
      "replay", "Simulate a recorded flight with its commands, and compare the models with the measurements");
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
                   "State of charge at the start, up to 1; default: fitted to the first voltages")
      ->check(positive());
  command->add_option("--window", options->window_s, "Length of the windows of the momentum balance [s]; default: 1")
      ->check(positive());
  command->add_flag("--hover", options->hover,
                    "The drone hovered, and the log has no motion: compare thrust with weight");
  command->footer(
      help_footer({"0 replayed", "1 a model failed, or a file could not be written", "2 the input cannot be used"},
                  {"mebots replay log00 --airframe configs/airframes/crazyflie_21.json --mass 0.0347 --out replay",
                   "mebots replay flight.csv --mapping columns.json --airframe my_drone.json --out replay"}));
  command->callback([options, &action] {
    action = [options] {
      return guarded([&] { become_python("mebots replay", "mebots.flight.command", words_of(*options)); });
    };
  });
}

void add_identify(CLI::App& app, Action& action) {
  const auto options = std::make_shared<IdentifyOptions>();
  auto* command =
      app.add_subcommand("identify", "Fit thrust or mass, and the cell, of an airframe to recorded flights");
  command->add_option("logs", options->logs, "Logs of one drone: Crazyflie uSD, ULog or CSV")
      ->type_name("FILE")
      ->required();
  command->add_option("--airframe", options->airframe, "Airframe to start from")->type_name("FILE.json")->required();
  command
      ->add_option("--out", options->out,
                   "Airframe to write; its rotor and cell are FILE.rotor.json and FILE.cell.json")
      ->type_name("FILE.json")
      ->required();
  command
      ->add_option(
          "--fit", options->fit,
          "What to fit, separated by commas: thrust or mass, and cell; default: thrust,cell. Flights determine the "
          "ratio of thrust to mass alone")
      ->type_name("NAMES")
      ->check(not_empty());
  command->add_option("--mapping", options->mapping, "Which column of the logs is which signal; needed for CSV")
      ->type_name("FILE.json")
      ->check(not_empty());
  command->add_option("--decks", options->decks, "Decks that the drone carried, in place of the airframe's: NAME,NAME")
      ->type_name("NAMES");
  command->add_option("--mass", options->mass_kg, "Mass of the whole drone [kg], in place of the airframe's")
      ->check(positive());
  command->add_flag("--hover", options->hover, "The drone hovered, and the logs have no motion");
  command->footer(help_footer(
      {"0 fitted", "1 a model failed, or a file could not be written", "2 the input cannot be used"},
      {"mebots identify log00 log01 --airframe configs/airframes/crazyflie_21.json --mass 0.0347 --out mine.json",
       "mebots identify log00 --airframe mine.json --fit mass --out heavier.json"}));
  command->callback([options, &action] {
    action = [options] {
      return guarded([&] { become_python("mebots identify", "mebots.flight.command", words_of(*options)); });
    };
  });
}

void add_new_cell(CLI::App& app, Action& action) {
  const auto options = std::make_shared<NewCellOptions>();
  auto* command =
      app.add_subcommand("new-cell", "Write a cell file, with intervals, from the data that a seller prints");
  command->add_option("out", options->out, "Cell file to write")->type_name("FILE.json")->required();
  command->add_option("--name", options->name, "Name of the cell")->type_name("TEXT")->required();
  command->add_option("--capacity", options->capacity_mah, "Capacity [mAh]")->required()->check(positive());
  command->add_option("--mass", options->mass_g, "Mass [g]")->required()->check(positive());
  command
      ->add_option("--c-rate", options->c_rate,
                   "Continuous current as a multiple of the capacity in an hour: 25 for 25C")
      ->required()
      ->check(positive());
  command->add_option("--resistance", options->resistance_ohm, "Measured series resistance [Ohm]")->check(positive());
  command
      ->add_option("--discharge", options->discharge,
                   "Log of a discharge from full, with voltage and current: resistance, polarisation and capacity are "
                   "fitted to it")
      ->type_name("FILE")
      ->check(not_empty());
  command->add_option("--mapping", options->mapping, "Which column of that log is which signal")
      ->type_name("FILE.json")
      ->check(not_empty());
  command->footer(
      help_footer({"0 written", "1 the model failed, or the file could not be written", "2 the input cannot be used"},
                  {"mebots new-cell my_cell.json --name 'Maker 300' --capacity 300 --mass 8.1 --c-rate 25",
                   "mebots new-cell my_cell.json --name 'Maker 300' --capacity 300 --mass 8.1 --c-rate 25 "
                   "--discharge bench.csv --mapping columns.json"}));
  command->callback([options, &action] {
    action = [options] {
      return guarded([&] { become_python("mebots new-cell", "mebots.flight.command", words_of(*options)); });
    };
  });
}

}  // namespace mebots::app
