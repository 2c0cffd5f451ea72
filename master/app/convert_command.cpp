// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"

#include "io/config/load_system.hpp"
#include "io/ssp/ssp.hpp"
#include "resolve/resolve.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace mebots::app {
namespace {

using namespace mebots::master;

void convert(const std::filesystem::path& from, const std::filesystem::path& to) {
  const auto ending = to.extension();
  if (ending != ".ssp" && ending != ".json") {
    throw InputError(ErrorCode::invalid_argument,
                     fmt::format("{}: name a file that ends in .ssp or .json", to.string()));
  }
  if (from.extension() == ending) {
    throw InputError(ErrorCode::invalid_argument,
                     fmt::format("{}: both files are {}; convert goes from .json to .ssp or from .ssp to .json",
                                 to.string(), ending.string()));
  }
  require_folder_of(to);
  auto loaded = load_system(from);
  config::make_signal_paths_absolute(loaded.config, loaded.system);
  FmuLibrary library;
  // Throws InputError before writing if the system is invalid.
  const auto resolved = resolve(loaded.system, library);
  if (ending == ".ssp") {
    write_ssp(resolved, loaded.config, to);
  } else {
    write_config(loaded.system, loaded.config, to);
  }
  for (const auto& notice : loaded.system.notices) fmt::print("notice: {}\n", notice);
  fmt::print("{}: {} instances, {} connections\n", to.string(), loaded.system.instances.size(),
             loaded.system.connections.size());
}

struct ConvertOptions {
  std::filesystem::path from;
  std::filesystem::path to;
};

}  // namespace

void add_convert(CLI::App& app, Action& action) {
  const auto options = std::make_shared<ConvertOptions>();
  auto* command = app.add_subcommand("convert", "Turn a config into an SSP, or an SSP into a config");
  command
      ->add_option("from", options->from,
                   "Config (.json), FMU (.fmu), SSP (.ssp, .ssd or its folder) or OspSystemStructure.xml")
      ->type_name("FILE")
      ->required();
  command->add_option("to", options->to, "SSP (.ssp) or config (.json) to write")->type_name("FILE")->required();
  command->footer(help_footer({"0 written", "1 the file could not be written", "2 the input cannot be used"},
                              {"mebots convert configs/gate_easy.json gate.ssp", "mebots convert gate.ssp gate.json"}));
  command->callback(
      [options, &action] { action = [options] { return guarded([&] { convert(options->from, options->to); }); }; });
}

}  // namespace mebots::app
