// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/system_description.hpp"

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master {

/// A hash of all inputs of a run: the config, every FMU, signal files, files named by String parameters (such as a
/// chip's program), and changes by the command line. If a String parameter names a deployed network, all files in its
/// folder are inputs.
struct InputHash {
  std::string all;
  /// The text that is hashed; contains one line for each input, which ends with the hash of the input.
  std::string lines;
  std::string config;
  std::vector<std::pair<std::string, std::string>> fmus;  ///< pairs of an instance and the hash of its FMU
  std::vector<std::pair<std::string, std::string>>
      files;  ///< pairs of instance.parameter (or the place of a signal) and the hash of the file
};

InputHash hash_inputs(const SystemDescription& system, std::span<const std::string> overrides);

}  // namespace mebots::master
