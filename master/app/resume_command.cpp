// SPDX-License-Identifier: Apache-2.0
#include "resume_command.hpp"

#include "run_command.hpp"

#include "base/input_error.hpp"

#include <cstdio>

namespace mebots::app {

int resume_command(const std::filesystem::path& folder, bool quiet) {
  RunOptions options;
  try {
    options.checkpoint = master::read_checkpoint(folder);
  } catch (const Error& error) {
    std::fprintf(stderr, "mebots: error: %s\n", error.what());
    return 2;
  }
  const auto& request = options.checkpoint->request;
  options.config = request.config;
  options.out = folder;
  options.sets = request.sets;
  options.scenarios = request.scenarios;
  if (!request.stop_time.empty()) options.stop_time_s = request.stop_time;
  options.isolate = request.isolate;
  options.quiet = quiet;
  return run_command(options);
}

}  // namespace mebots::app
