// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/series.hpp"
#include "record/sink/row_block.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// Stores rows in memory as one series of numbers per variable. Booleans become 0 and 1; texts are omitted. Another
/// thread writes the rows, so read them only after Recorder::flush().
class MemorySink final : public RowSink {
 public:
  explicit MemorySink(const std::vector<RecordColumn>& columns);

  const std::vector<double>& times_s() const { return times_s_; }
  const std::vector<Series>& series() const { return series_; }
  /// Returns the series of a variable, or null if the variable is not recorded.
  const Series* find(std::string_view name) const;

  void write(const RowBlock& block) override;
  void flush() override {}
  void keep_rows(std::int64_t rows) override;
  /// Saves or restores the rows. They are not part of a checkpoint, so a run without this sink can resume from the same
  /// checkpoint.
  void visit_rows(state::Visitor& v);

 private:
  struct Source {
    std::size_t cell;  // index in a row without the time
    modeldesc::Type type;
  };

  std::vector<Source> sources_;  // indexed by series
  std::vector<double> times_s_;
  std::vector<Series> series_;
};

}  // namespace mebots::master
