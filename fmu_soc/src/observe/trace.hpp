// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/hart.hpp"
#include "hart/observer.hpp"
#include "observe/text_file.hpp"

#include <string>

namespace mebots::soc::observe {

/// Writes every retired instruction as Spike's `--log-commits` does, one line each:
/// `core   0: 3 0x80000008 (0x00c5a603) x12 0x00000007 mem 0x80001100`: privilege mode, pc, instruction word, register
/// written, CSR written, address of a load, address and value of a store. Xpulp's post-increments, which Spike does not
/// know, show the address register as a second one.
class Trace final : public Observer {
 public:
  struct Columns {
    bool cycles = false;  // "# cycle" at the end of a line: the active cycle after the instruction
  };
  Trace(const std::string& option, const std::string& path, Columns columns) : columns_(columns), file_(option, path) {}

  void retired(const Hart& hart, const Retired& instruction) override;
  void close() { file_.close(); }

 private:
  Columns columns_;
  TextFile file_;
};

}  // namespace mebots::soc::observe
