// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/soc/time.hpp"
#include "mebots/state/visitor.hpp"

#include <algorithm>

namespace mebots::soc {

/// How long something has gone on, all in all. Who asks may be behind its last begin, or ahead of its end: the parts of
/// a chip are not all at the same time.
class Stopwatch {
 public:
  bool runs() const { return runs_; }
  void begin(Picoseconds time) {
    runs_ = true;
    changed_at_ = time;
  }
  void end(Picoseconds time) {
    total_ = up_to(time);
    runs_ = false;
    changed_at_ = time;
  }
  /// When it began or ended last.
  Picoseconds changed_at() const { return changed_at_; }
  Picoseconds up_to(Picoseconds now) const {
    return runs_ ? total_ + std::max<Picoseconds>(now - changed_at_, 0) : total_;
  }

  void visit(state::Visitor& v) {
    v("runs", runs_);
    v("changed_at", changed_at_);
    v("total", total_);
  }

 private:
  bool runs_ = false;
  Picoseconds changed_at_ = 0;
  Picoseconds total_ = 0;  // up to its last begin
};

}  // namespace mebots::soc
