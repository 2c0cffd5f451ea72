// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"
#include "progress.hpp"

#include "new_fmu.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

namespace mebots::app {
namespace {

struct NewFmuOptions {
  std::filesystem::path description;
  std::filesystem::path out;
};

int new_fmu_command(const NewFmuOptions& options) {
  try {
    const auto folder = new_fmu::new_fmu(options.description, options.out).string();
    const auto word = shell_word(folder);
    fmt::print(
        "{0} is written. Next:\n"
        "  cmake -S {1} -B {1}/build -DCMAKE_BUILD_TYPE=Release && cmake --build {1}/build && ctest --test-dir "
        "{1}/build\n"
        "  mebots check {1}/build/fmus/*.fmu\n"
        "then put your equations into {0}/src/model.cpp\n",
        folder, word);
    return 0;
  } catch (const std::exception& error) {
    print_error(error.what());
    return 2;
  }
}

}  // namespace

void add_new_fmu(CLI::App& app, Action& action) {
  const auto options = std::make_shared<NewFmuOptions>();
  auto* command = app.add_subcommand("new-fmu", "Create the project folder of a new FMU from its description");
  command->add_option("description", options->description, "description.json with the FMU's variables")
      ->type_name("FILE.json")
      ->required();
  command->add_option("--out", options->out, "Folder to create; default: the FMU's name")
      ->type_name("FOLDER")
      ->check(not_empty());
  command->footer(help_footer({"0 written", "2 the description cannot be used, or the folder exists"},
                              {"mebots new-fmu description.json --out my_fmu"}));
  command->callback([options, &action] { action = [options] { return new_fmu_command(*options); }; });
}

}  // namespace mebots::app
