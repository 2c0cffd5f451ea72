// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"

#include "mebots/error.hpp"
#include "mebots/input_error.hpp"
#include "mebots/modeldesc/merge_fmus.hpp"

#include <filesystem>
#include <memory>
#include <vector>

namespace mebots::app {
namespace {

struct MergeOptions {
  std::filesystem::path fmu;
  std::vector<std::filesystem::path> others;
  std::filesystem::path out;
};

void merge(const MergeOptions& options) {
  std::vector<std::filesystem::path> archives = {options.fmu};
  archives.insert(archives.end(), options.others.begin(), options.others.end());
  const auto& target = options.out.empty() ? options.fmu : options.out;
  require_folder_of(target);
  try {
    modeldesc::merge_fmus(archives, target);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::file_unwritable) throw;
    throw InputError(error.code(), error.what());
  }
}

}  // namespace

void add_fmu_platforms(CLI::App& app, Action& action) {
  const auto options = std::make_shared<MergeOptions>();
  auto* command = app.add_subcommand("fmu-platforms", "Merge builds of one FMU for several platforms into one archive");
  command->add_option("fmu", options->fmu, "FMU file, into which the binaries of the other builds are copied")
      ->type_name("FILE.fmu")
      ->required();
  command->add_option("others", options->others, "Builds of the same FMU for other platforms")
      ->type_name("ADD.fmu...")
      ->required();
  command->add_option("--out", options->out, "Write another file and leave FILE.fmu as it is")->type_name("FILE.fmu");
  command->footer(help_footer(
      {"0 merged", "1 the archive cannot be written", "2 an archive cannot be read, or they are not builds of one FMU"},
      {"mebots fmu-platforms fmu_motors.fmu win64/fmu_motors.fmu arm64/fmu_motors.fmu --out all/fmu_motors.fmu"}));
  command->callback([options, &action] { action = [options] { return guarded([&] { merge(*options); }); }; });
}

}  // namespace mebots::app
