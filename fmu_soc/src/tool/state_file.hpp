// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "observe/text_file.hpp"
#include "tool/run.hpp"

#include "soc/soc.hpp"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mebots::soc::tool {

/// Reads and writes a chip's state in a file, with `--load-state` and `--save-state`.
///
/// The file begins with lines of text: the version of the format, a checksum of each input of the run and of this
/// program, and the layout of the state. When the state is loaded, these lines must be equal to those of the present
/// run. A checksum of the state and its bytes follow.
class StateFile {
 public:
  /// Reads the inputs of the run for their checksums. Throws Error if an input cannot be read.
  StateFile(const Options& options, const Soc& soc);

  /// Restores the chip's state. Throws Error if the file is not readable, is damaged, or has the state of another
  /// program, board or build. If the function throws, the chip must not be used.
  void load(const std::string& path, Soc& soc) const;
  /// Writes the chip's state. If the program has ended or an observer has stopped it, removes the file and throws
  /// Error, because such a state cannot continue.
  void save(observe::TextFile& file, const Soc& soc) const;

 private:
  /// Name and value of a line before the state.
  std::vector<std::pair<std::string_view, std::string>> lines_;
};

}  // namespace mebots::soc::tool
