// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "model/value_kind.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Data that the simulation passes to the files of results.
namespace mebots::master {

/// A recorded variable.
struct RecordColumn {
  std::string name;  ///< "instance.variable"
  std::string unit;  ///< empty = none
  modeldesc::Type type = modeldesc::Type::real;

  ValueKind kind() const { return kind_of(type); }
};

/// A parameter and its value as text, in the notation of results.csv.
struct ParameterValue {
  std::string name;
  std::string unit;
  std::string value;
  modeldesc::Type type = modeldesc::Type::string;
};

/// The number of cells per block: 128 KiB, which fit into the cache of a core.
inline constexpr std::size_t kBlockCells = 1 << 14;

/// Rows as raw numbers, so that the simulation does not wait for formatting. A row consists of its time [s] and one
/// cell per column. A cell contains the bits of a double, a whole number, or the index of a text in `texts`.
struct RowBlock {
  std::size_t cells_per_row = 1;
  std::vector<std::uint64_t> cells;
  std::vector<std::string> texts;

  std::size_t rows() const { return cells.size() / cells_per_row; }
  void clear() {
    cells.clear();
    texts.clear();
  }
};

/// Receives the rows of a run in order.
class RowSink {
 public:
  virtual ~RowSink() = default;

  /// write() may be called by another thread than the other functions, but never at the same time as one of them.
  /// Throws Error if the disk is full or fails.
  virtual void write(const RowBlock& block) = 0;
  /// Writes all rows received so far to the file.
  virtual void flush() = 0;

  /// Visits the state that the sink needs to continue from a saved state. Restoring it sets the sink back.
  virtual void visit(state::Visitor& /*v*/) {}
  /// Returns the name of its state. Empty if it has none; such a sink may be absent in a resumed run.
  virtual std::string_view state_name() const { return {}; }
  /// Called after a state is restored: the sink keeps the first `rows` rows. Throws Error if it has fewer.
  virtual void keep_rows(std::int64_t /*rows*/) {}
};

}  // namespace mebots::master
