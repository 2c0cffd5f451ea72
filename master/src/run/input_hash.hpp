// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/system_description.hpp"

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master {

/// Fingerprint of all that a run depends on. The config's bytes, every FMU's bytes, the bytes of files that texts
/// among the parameters name (a program for a chip, say), those of files of signals, and what the command line changed.
struct InputHash {
  std::string all;
  std::string lines;  ///< what `all` is the hash of: one line per input, its own hash last
  std::string config;
  std::vector<std::pair<std::string, std::string>> fmus;  ///< instance, hash of its FMU
  std::vector<std::pair<std::string, std::string>>
      files;  ///< instance.parameter or the place of a signal, hash of the file
};

InputHash hash_inputs(const SystemDescription& system, std::span<const std::string> overrides);

}  // namespace mebots::master
