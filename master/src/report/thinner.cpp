// SPDX-License-Identifier: Apache-2.0
#include "report/thinner.hpp"

#include "mebots/assert.hpp"

#include <algorithm>

namespace mebots::master::report {

Thinner::Thinner(std::size_t columns, std::size_t span)
    : span_(span), least_(columns), greatest_(columns), values_(columns) {
  MEBOTS_ASSERT(span > 0);
}

void Thinner::add(std::span<const double> row) {
  MEBOTS_ASSERT(row.size() == values_.size());
  if (span_ == 1) return keep(row);
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (rows_ == 0 || row[i] < least_[i].value) least_[i] = {row[i], rows_};
    if (rows_ == 0 || row[i] > greatest_[i].value) greatest_[i] = {row[i], rows_};
  }
  if (++rows_ == span_) finish();
}

void Thinner::keep(std::span<const double> row) {
  MEBOTS_ASSERT(row.size() == values_.size());
  finish();
  for (std::size_t i = 0; i < row.size(); ++i) values_[i].push_back(row[i]);
}

void Thinner::finish() {
  if (rows_ == 0) return;
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const auto& [first, last] =
        std::minmax(least_[i], greatest_[i], [](const Extreme& a, const Extreme& b) { return a.row < b.row; });
    values_[i].push_back(first.value);
    if (rows_ > 1) values_[i].push_back(last.value);
  }
  rows_ = 0;
}

}  // namespace mebots::master::report
