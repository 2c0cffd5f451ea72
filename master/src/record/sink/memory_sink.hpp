// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/series.hpp"
#include "record/sink/row_block.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// Keeps the recorded rows in memory: one column of numbers per variable; Booleans as 0 and 1. Texts are left out.
/// Read it only after RowSink::flush of the recorder: rows may come on another thread.
class MemorySink final : public RowSink {
 public:
  explicit MemorySink(const std::vector<RecordColumn>& columns);

  const std::vector<double>& times_s() const { return times_s_; }
  const std::vector<Series>& series() const { return series_; }
  /// Null when the variable is not recorded.
  const Series* find(std::string_view name) const;

  void write(const RowBlock& block) override;
  void flush() override {}
  /// Goes back to fewer rows than there are, or as many.
  void visit(state::Visitor& v) override;
  /// The rows themselves, which are not part of the state above.
  void visit_rows(state::Visitor& v);

 private:
  struct Source {
    std::size_t cell;  // in a row, behind the time
    modeldesc::Type type;
  };

  std::vector<Source> sources_;  // one per series
  std::vector<double> times_s_;
  std::vector<Series> series_;
};

}  // namespace mebots::master
