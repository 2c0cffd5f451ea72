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

/// Writes a chip's state to a file (`--save-state`) and reads it back (`--load-state`).
///
/// The file begins with text lines: the version of the format, a checksum of each input of the run and of this program,
/// and the layout of the state. A state can be loaded only if these lines are the same in the present run. The checksum
/// and the bytes of the state follow.
class StateFile {
 public:
  /// Computes the checksums of the run's inputs. Throws Error if an input cannot be read.
  StateFile(const Options& options, const Soc& soc);

  /// Restores the chip's state. Throws Error if the file cannot be read, is damaged, or contains the state of another
  /// program, board or build. If the function throws, the chip must not be used.
  void load(const std::string& path, Soc& soc) const;
  /// Writes the chip's state. If the program has ended, or if an observer has stopped the run, deletes the file and
  /// throws Error.
  void save(observe::TextFile& file, const Soc& soc) const;

 private:
  std::vector<std::pair<std::string_view, std::string>> lines_;
};

}  // namespace mebots::soc::tool
