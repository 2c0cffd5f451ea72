// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/system_description.hpp"

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master {

/// A fingerprint of all inputs of a run: the bytes of the config, of every FMU, of the files named by text parameters
/// (such as a chip's program; of a deployed network, all files of its folder) and of signal files, and the changes by
/// the command line.
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
