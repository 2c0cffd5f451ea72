// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/series.hpp"
#include "record/sink/row_block.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::master {

/// Stores recorded rows in memory, as one series of numbers for each variable. Booleans are stored as 0 and 1.
/// Variables whose values are texts are left out. The rows may be read only after the recorder's flush(), because
/// another thread writes them.
class MemorySink final : public RowSink {
 public:
  explicit MemorySink(const std::vector<RecordColumn>& columns);

  const std::vector<double>& times_s() const { return times_s_; }
  const std::vector<Series>& series() const { return series_; }
  /// Returns the series of a variable. Returns null if the variable is not recorded.
  const Series* find(std::string_view name) const;

  void write(const RowBlock& block) override;
  void flush() override {}
  void keep_rows(std::int64_t rows) override;
  /// Visits the rows. They are not part of the recorder's state. Therefore a run with this sink and a run without it
  /// can resume from the same checkpoint.
  void visit_rows(state::Visitor& v);

 private:
  struct Source {
    std::size_t cell;  // index in a row; the time is not counted
    modeldesc::Type type;
  };

  std::vector<Source> sources_;  // one for each series
  std::vector<double> times_s_;
  std::vector<Series> series_;
};

}  // namespace mebots::master
