// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace mebots::master::report {

/// A span of simulated time, including both ends.
struct TimeSpan {
  double from_s = 0;
  double to_s = 0;

  bool holds(double time_s) const { return from_s <= time_s && time_s <= to_s; }
};

/// The content of results.csv, by columns.
struct ResultTable {
  struct Column {
    std::string name;  ///< "instance.variable"; the first column is "time"
    std::string unit;  ///< "-" if the column has no unit
    std::vector<double> values;
  };
  std::vector<Column> columns;
  std::vector<std::string> texts;  ///< names of columns with texts, which `columns` omits
  std::size_t rows = 0;            ///< number of rows in results.csv
  std::size_t span = 1;            ///< number of consecutive rows that were reduced to two
  std::vector<TimeSpan> whole;     ///< spans of time in which every row is kept

  /// Maximum number of values in a page. A larger page would be too large for mail.
  static constexpr std::size_t kMostValues = 600'000;
  /// Returns the number of consecutive rows that a Thinner must reduce to two, so that at most about kMostValues values
  /// remain; 1 if the table is small enough. `columns` includes the time.
  static std::size_t span_of(std::size_t rows, std::size_t columns);
};

/// Reads results.csv and reduces it with a Thinner. Keeps every row within the spans `whole`. Ignores an incomplete
/// last line of a killed run. Columns in `texts` contain texts even if they look like numbers, such as the Binary 0102.
/// Throws InputError if the file is not such a table.
ResultTable read_results(const std::filesystem::path& file, const std::vector<TimeSpan>& whole = {},
                         const std::set<std::string>& texts = {});

/// Reduces a table but keeps its minima and maxima. Every `span` consecutive rows become two rows at the times of the
/// first and the last row. In each column, the two rows contain the minimum and the maximum in the order of their
/// occurrence. Monotonic columns, such as energy counters, therefore keep exact values at both times.
class Thinner {
 public:
  /// Every `span` consecutive rows become two rows. If `span` is 1, all rows are kept. The first column must be the
  /// time.
  Thinner(std::size_t columns, std::size_t span);

  void add(std::span<const double> row);
  /// Reduces the rows that add() has received since the last complete span. After that, adds this row unchanged.
  void keep(std::span<const double> row);
  /// Reduces the rows that add() has received since the last complete span. Must be called after the last row.
  void finish();

  std::vector<std::vector<double>>& values() { return values_; }

 private:
  struct Extreme {
    double value = 0;
    std::size_t row = 0;  // index within the span
  };

  std::size_t span_;
  std::size_t rows_ = 0;  // number of rows in the current span
  std::vector<Extreme> least_;
  std::vector<Extreme> greatest_;
  std::vector<std::vector<double>> values_;
};

}  // namespace mebots::master::report
