// SPDX-License-Identifier: Apache-2.0
#include "new_fmu_command.hpp"

#include "mebots/error.hpp"
#include "new_fmu.hpp"

#include <cstdio>
#include <exception>

namespace mebots::app {

int new_fmu_command(const std::filesystem::path& description, const std::filesystem::path& out) {
  try {
    const auto folder = new_fmu::new_fmu(description, out).string();
    std::printf(
        "%s is written. Next:\n"
        "  cmake -S %s -B %s/build -DCMAKE_BUILD_TYPE=Release && cmake --build %s/build && ctest --test-dir %s/build\n"
        "  mebots check %s/build/fmus/*.fmu\n"
        "then put your equations into %s/src/model.cpp\n",
        folder.c_str(), folder.c_str(), folder.c_str(), folder.c_str(), folder.c_str(), folder.c_str(), folder.c_str());
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mebots: error: %s\n", error.what());
    return 2;
  }
}

}  // namespace mebots::app
