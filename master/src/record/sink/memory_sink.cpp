// SPDX-License-Identifier: Apache-2.0
#include "record/sink/memory_sink.hpp"

#include "mebots/error.hpp"

#include <algorithm>
#include <bit>

namespace mebots::master {

namespace {

/// Converts a cell to a double. Rounds integers above 2^53.
double number(modeldesc::Type type, std::uint64_t cell) {
  if (kind_of(type) == ValueKind::real) return std::bit_cast<double>(cell);
  return type == modeldesc::Type::uint64 ? static_cast<double>(cell)
                                         : static_cast<double>(static_cast<std::int64_t>(cell));
}

}  // namespace

MemorySink::MemorySink(const std::vector<RecordColumn>& columns) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].kind() == ValueKind::string || columns[i].kind() == ValueKind::binary) continue;
    sources_.push_back({i, columns[i].type});
    series_.push_back({columns[i].name, columns[i].unit, {}});
  }
}

const Series* MemorySink::find(std::string_view name) const {
  const auto found = std::ranges::find(series_, name, [](const Series& one) { return std::string_view(one.name); });
  return found == series_.end() ? nullptr : &*found;
}

void MemorySink::write(const RowBlock& block) {
  for (std::size_t row = 0; row < block.rows(); ++row) {
    const auto* cells = block.cells.data() + row * block.cells_per_row;
    times_s_.push_back(std::bit_cast<double>(cells[0]));
    for (std::size_t i = 0; i < sources_.size(); ++i) {
      const auto cell = cells[1 + sources_[i].cell];
      series_[i].values.push_back(number(sources_[i].type, cell));
    }
  }
}

void MemorySink::keep_rows(std::int64_t rows) {
  const auto kept = static_cast<std::size_t>(rows);
  if (kept > times_s_.size()) throw Error(ErrorCode::state_damaged, "a saved state has more rows than are in memory");
  times_s_.resize(kept);
  for (auto& one : series_) one.values.resize(kept);
}

void MemorySink::visit_rows(state::Visitor& v) {
  v("times_s", times_s_);
  for (auto& one : series_) v(one.name, one.values);
}

}  // namespace mebots::master
