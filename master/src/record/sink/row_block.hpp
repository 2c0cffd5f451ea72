// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "model/value_kind.hpp"

#include <cstdint>
#include <string>
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

  /// Visits the part of the sink's state that a resumed run needs. Restoring a state drops the rows after it.
  virtual void visit(state::Visitor& v) = 0;
};

}  // namespace mebots::master
