// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/observer.hpp"
#include "observe/text_file.hpp"
#include "runs/hart.hpp"

#include <deque>
#include <string>

namespace mebots::soc::observe {

/// Writes a line for every instruction that a hart retires, in the format of Spike's `--log-commits`: `core 0: 3
/// 0x80000008 (0x00c5a603) x12 0x00000007 mem 0x80001100`. The columns are privilege mode, pc, instruction word,
/// written register, written CSR, address of a load, address and value of a store. For a post-increment of Xpulp, the
/// address register is listed as a second register. The number of a core is that of the chip's hart. Lines of one hart
/// are in the order of time; lines of different harts may be out of order.
class Trace {
 public:
  struct Columns {
    bool cycles = false;  // append "# cycle" to each line: the active cycle after the instruction
  };
  Trace(const std::string& option, const std::string& path, Columns columns, unsigned harts);

  /// Returns the observer to attach to the hart `number`.
  Observer& hart(unsigned number) { return harts_[number]; }
  void close() { file_.close(); }

 private:
  class HartObserver final : public Observer {
   public:
    HartObserver(Trace& trace, unsigned number) : trace_(trace), number_(number) {}
    void retired(const Hart& hart, const Retired& instruction) override { trace_.put(number_, hart, instruction); }

   private:
    Trace& trace_;
    unsigned number_;
  };
  void put(unsigned number, const Hart& hart, const Retired& instruction);

  Columns columns_;
  TextFile file_;
  std::deque<HartObserver> harts_;
};

}  // namespace mebots::soc::observe
