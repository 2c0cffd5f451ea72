// SPDX-License-Identifier: Apache-2.0
#include "fmi/fmi2_functions.hpp"

#include "mebots/input_error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

namespace mebots::master {

Fmi2Functions load_functions(void* library, const std::string& archive) {
  const auto functions = fmi2::find_functions(library);
  std::vector<std::string> missing;
  fmi2::for_each_function([&](const char* name, auto member, fmi2::Need need) {
    if (need == fmi2::Need::to_run && functions.*member == nullptr) missing.emplace_back(name);
  });
  if (!missing.empty()) {
    throw InputError(ErrorCode::fmu_inconsistent,
                     fmt::format("{}: the FMU's shared library lacks functions that FMI 2.0 demands: {}", archive,
                                 fmt::join(missing, ", ")));
  }
  return functions;
}

}  // namespace mebots::master
