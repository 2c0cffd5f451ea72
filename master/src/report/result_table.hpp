// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace mebots::master::report {

/// A span of simulated time, both ends included.
struct TimeSpan {
  double from_s = 0;
  double to_s = 0;

  bool holds(double time_s) const { return from_s <= time_s && time_s <= to_s; }
};

/// What results.csv holds, column by column.
struct ResultTable {
  struct Column {
    std::string name;  ///< "instance.variable"; the first is "time"
    std::string unit;  ///< "-" without one
    std::vector<double> values;
  };
  std::vector<Column> columns;
  std::vector<std::string> texts;  ///< names of columns that hold texts, which are left out
  std::size_t rows = 0;            ///< in the file
  std::size_t span = 1;            ///< how many of them a Thinner made two of
  std::vector<TimeSpan> whole;     ///< where it left every row as it is

  /// Numbers that a page holds at most, so that it stays one that people send to each other. A longer table is thinned
  /// out.
  static constexpr std::size_t kMostValues = 600'000;
  /// The span of a table of so many rows and columns, the time among them.
  static std::size_t span_of(std::size_t rows, std::size_t columns);
};

/// Reads results.csv; every row stays within the spans `whole`, however long the table is. A last line that is cut off,
/// of a run that was killed, is left out. Throws InputError for a file that is not such a table.
ResultTable read_results(const std::filesystem::path& file, const std::vector<TimeSpan>& whole = {});

}  // namespace mebots::master::report
