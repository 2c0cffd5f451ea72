// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/system_description.hpp"

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master {

/// Hashes of all inputs of a run: the config, FMUs, signal files, files that String parameters name, and changes to the
/// config. If a parameter `network` names a folder that `mebots deploy` wrote, all files in this folder are inputs.
struct InputHash {
  std::string all;
  /// The text whose hash is `all`. Contains one line per input, which ends with the input's hash.
  std::string lines;
  std::string config;
  std::vector<std::pair<std::string, std::string>> fmus;  ///< pairs of instance name and hash of its FMU
  std::vector<std::pair<std::string, std::string>>
      files;  ///< pairs of "instance.parameter" or the place of a signal, and hash of the file
};

InputHash hash_inputs(const SystemDescription& system, std::span<const std::string> overrides);

}  // namespace mebots::master
