// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace mebots::master::report {

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
  std::size_t every = 1;           ///< of these rows, every how many-th is in `values`

  /// Numbers that a page holds at most. A longer table is thinned out; its last row stays.
  static constexpr std::size_t kMostValues = 4'000'000;
};

/// Reads results.csv. A last line that is cut off, of a run that was killed, is left out. Throws InputError for a file
/// that is no such table.
ResultTable read_results(const std::filesystem::path& file);

}  // namespace mebots::master::report
