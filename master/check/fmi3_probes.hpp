// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "child.hpp"
#include "fmi3_description.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

/// Experiments with an FMI 3.0 FMU through its C interface, as in an importing tool.
namespace mebots::check {

struct Fmi3Target {
  const Fmi3Description* description;
  std::filesystem::path folder;   ///< the unpacked FMU
  std::filesystem::path library;  ///< its shared library
};

/// Returns the probes of co-simulation.
std::vector<ChildProbe> fmi3_probes(const Fmi3Target& target);

}  // namespace mebots::check
