// SPDX-License-Identifier: Apache-2.0
#include "convert_command.hpp"

#include "ssp/ssp.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace mebots::app {
namespace {

using namespace mebots::master;

void convert(const std::filesystem::path& from, const std::filesystem::path& to) {
  const auto ending = to.extension();
  if (ending != ".ssp" && ending != ".json") {
    throw InputError(fmt::format("{}: name a file that ends in .ssp or .json", to.string()));
  }
  if (from.extension() == ending) {
    throw InputError(fmt::format("{}: both files are {}; convert goes from .json to .ssp or from .ssp to .json",
                                 to.string(), ending.string()));
  }
  if (const auto folder = to.parent_path(); !folder.empty() && !std::filesystem::is_directory(folder)) {
    throw InputError(fmt::format("{}: there is no folder {}; make it first", to.string(), folder.string()));
  }
  const auto loaded = load_system(from);
  FmuLibrary library;
  const auto resolved = resolve(loaded.system, library);  // nothing broken is handed on
  if (ending == ".ssp") {
    write_ssp(resolved, loaded.config, to);
  } else {
    write_config(loaded.system, loaded.config, to);
  }
  for (const auto& notice : loaded.system.notices) fmt::print("notice: {}\n", notice);
  fmt::print("{}: {} instances, {} connections\n", to.string(), loaded.system.instances.size(),
             loaded.system.connections.size());
}

}  // namespace

int convert_command(const std::filesystem::path& from, const std::filesystem::path& to) {
  try {
    convert(from, to);
    return 0;
  } catch (const InputError& error) {
    std::fprintf(stderr, "mebots: error: %s\n", error.what());
    return 2;
  } catch (const Error& error) {
    std::fprintf(stderr, "mebots: error: %s\n", error.what());
    return 1;
  }
}

}  // namespace mebots::app
