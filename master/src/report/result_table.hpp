// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace mebots::master::report {

/// A span of simulated time, both ends included.
struct TimeSpan {
  double from_s = 0;
  double to_s = 0;

  bool holds(double time_s) const { return from_s <= time_s && time_s <= to_s; }
};

/// The columns of results.csv.
struct ResultTable {
  struct Column {
    std::string name;  ///< "instance.variable"; the first is "time"
    std::string unit;  ///< "-" without one
    std::vector<double> values;
  };
  std::vector<Column> columns;
  std::vector<std::string> texts;  ///< names of columns that hold texts, which are left out
  std::size_t rows = 0;            ///< in the file
  std::size_t span = 1;            ///< rows that a Thinner reduces to two
  std::vector<TimeSpan> whole;     ///< spans with every row kept

  /// Most numbers in a page, so that people can still mail it. A longer table is thinned out.
  static constexpr std::size_t kMostValues = 600'000;
  /// Returns the span for a table of this size. `columns` includes the time.
  static std::size_t span_of(std::size_t rows, std::size_t columns);
};

/// Reads results.csv. Within the spans `whole`, every row is kept. Skips an incomplete last line, which a killed run
/// leaves. Throws InputError for a file that is not such a table.
ResultTable read_results(const std::filesystem::path& file, const std::vector<TimeSpan>& whole = {});

/// Thins out rows so that extremes stay: of every `span` rows that follow each other two remain, at the times of the
/// first and the last of them. A column has its least and its greatest number of the span there, in the order in which
/// they came. So what only grows, as a count of energy does, keeps its exact values at both times.
class Thinner {
 public:
  /// A span of 1 keeps every row. The first column is the time.
  Thinner(std::size_t columns, std::size_t span);

  void add(std::span<const double> row);
  /// Adds a row that is kept. Ends the open span before it.
  void keep(std::span<const double> row);
  /// Ends the last span, which may be shorter.
  void finish();

  /// By column.
  std::vector<std::vector<double>>& values() { return values_; }

 private:
  struct Extreme {
    double value = 0;
    std::size_t row = 0;  // of the span
  };

  std::size_t span_;
  std::size_t rows_ = 0;  // in the open span
  std::vector<Extreme> least_;
  std::vector<Extreme> greatest_;
  std::vector<std::vector<double>> values_;
};

}  // namespace mebots::master::report
