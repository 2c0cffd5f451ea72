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

/// An experiment, run in a separate child process.
struct Fmi3Probe {
  std::string name;     ///< a statement that holds if the probe finds no error
  std::string skipped;  ///< why it does not apply to this FMU; empty if it applies
  std::function<void(Witness&)> run;
  bool is_plain = false;  ///< a plain run: if it fails, the following probes are skipped
};

/// Returns the probes of co-simulation, then those of model exchange.
std::vector<Fmi3Probe> fmi3_probes(const Fmi3Target& target);

}  // namespace mebots::check
