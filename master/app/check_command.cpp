// SPDX-License-Identifier: Apache-2.0
#include "check_command.hpp"

#include "check_fmu.hpp"
#include "mebots/error.hpp"

#include <cstdio>

namespace mebots::app {

int check_command(const CheckOptions& options) {
  try {
    check::Options how;
    how.half_step_tolerance = options.half_step_tolerance;
    how.deadline_s = options.deadline_s;
    how.run = !options.files_only;
    const auto report = check::check_fmu(options.fmu, how);
    const auto text = options.json ? check::to_json(report) : check::to_text(report);
    std::fputs(text.c_str(), stdout);
    return report.clean() ? 0 : 1;
  } catch (const Error& error) {
    std::fprintf(stderr, "mebots: error: %s\n", error.what());
    return 2;
  }
}

}  // namespace mebots::app
