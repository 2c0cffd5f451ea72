// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"
#include "progress.hpp"

#include "new_folder.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

namespace mebots::app {
namespace {

/// Calls `write`, which writes a folder and returns its path. Prints the next commands for the user.
template <typename Write>
int written(const Write& write, const char* targets) {
  try {
    const auto folder = write().string();
    fmt::print("{} is written. Next:\n  cd {}\n  cmake -S . -B build && cmake --build build\n{}", folder,
               shell_word(folder), targets);
    return 0;
  } catch (const std::exception& error) {
    print_error(error.what());
    return 2;
  }
}

const std::vector<std::string> kExitCodesOfWriting = {"0 written", "2 a name cannot be used, or the folder exists"};

}  // namespace

void add_new_firmware(CLI::App& app, Action& action) {
  struct Options {
    std::string name;
    std::string language = "c";
    std::filesystem::path out;
  };
  const auto options = std::make_shared<Options>();
  auto* command = app.add_subcommand("new-firmware", "Create the project folder of a new program for the chip");
  command->add_option("name", options->name, "Its name: lower-case letters, digits and _")
      ->type_name("NAME")
      ->required();
  command->add_option("--language", options->language, "Its language; a program in C may have C++ files, too")
      ->capture_default_str()
      ->check(CLI::IsMember({"c", "rust"}));
  command->add_option("--out", options->out, "Folder to create; default: the name")
      ->type_name("FOLDER")
      ->check(not_empty());
  command->footer(
      help_footer(kExitCodesOfWriting, {"mebots new-firmware blink", "mebots new-firmware blink --language rust"}));
  command->callback([options, &action] {
    action = [options] {
      const auto language = options->language == "rust" ? new_folder::Language::rust : new_folder::Language::c;
      return written([&] { return new_folder::new_firmware(options->name, language, options->out); },
                     "  cmake --build build --target run\n");
    };
  });
}

void add_new_sensor(CLI::App& app, Action& action) {
  struct Options {
    new_folder::Sensor sensor;
    std::filesystem::path out;
  };
  const auto options = std::make_shared<Options>();
  auto& sensor = options->sensor;
  auto* command = app.add_subcommand(
      "new-sensor", "Create the project folder of a new sensor of the chip: driver, firmware and mission");
  command->add_option("name", sensor.name, "Its name: lower-case letters, digits and _")->type_name("NAME")->required();
  command->add_option("--senses", sensor.senses, "Variable that it measures: a Real output of world, motors or battery")
      ->type_name("INSTANCE.VARIABLE")
      ->capture_default_str();
  command
      ->add_option("--board", sensor.board, "Board file to which the sensor is added; default: a board with GAP8 alone")
      ->type_name("FILE.json")
      ->check(CLI::ExistingFile);
  command->add_flag("--cpp", sensor.with_code,
                    "Add a device model in C++, for behaviour that the board file cannot describe");
  command->add_option("--out", options->out, "Folder to create; default: the name")
      ->type_name("FOLDER")
      ->check(not_empty());
  command->footer(help_footer(kExitCodesOfWriting, {"mebots new-sensor height",
                                                    "mebots new-sensor voltmeter --senses battery.bus.voltage --cpp"}));
  command->callback([options, &action] {
    action = [options] {
      return written([&] { return new_folder::new_sensor(options->sensor, options->out); },
                     "  cmake --build build --target run    # the firmware alone\n"
                     "  cmake --build build --target fly    # in the mission\n");
    };
  });
}

}  // namespace mebots::app
