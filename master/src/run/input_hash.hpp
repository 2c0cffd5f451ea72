// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/system_description.hpp"

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master {

/// A hash of all inputs of a run. The inputs are the config, every FMU, signal files, files named by String parameters,
/// such as a chip's program, and changes by the command line. If a String parameter names a deployed network, all files
/// of its folder are inputs.
struct InputHash {
  std::string all;
  std::string lines;  ///< the hashed text: one line per input, ending in its own hash
  std::string config;
  std::vector<std::pair<std::string, std::string>> fmus;  ///< instance, hash of its FMU
  std::vector<std::pair<std::string, std::string>>
      files;  ///< instance.parameter or the place of a signal, hash of the file
};

InputHash hash_inputs(const SystemDescription& system, std::span<const std::string> overrides);

}  // namespace mebots::master
