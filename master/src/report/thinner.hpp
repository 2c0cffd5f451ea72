// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace mebots::master::report {

/// Thins out rows so that extremes stay: of every `span` rows that follow each other two remain, at the times of the
/// first and the last of them. A column has its least and its greatest number of the span there, in the order in which
/// they came. So what only grows, as a count of energy does, keeps its exact values at both times.
class Thinner {
 public:
  /// A span of 1 keeps every row as it is. The first column is the time.
  Thinner(std::size_t columns, std::size_t span);

  void add(std::span<const double> row);
  /// A row that stays as it is; the open span ends before it.
  void keep(std::span<const double> row);
  /// What is left over is a shorter span.
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
