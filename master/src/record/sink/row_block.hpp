// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "model/value_kind.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Declares the data that the simulation passes to the writers of result files.
namespace mebots::master {

/// Describes a recorded variable.
struct RecordColumn {
  std::string name;  ///< "instance.variable"
  std::string unit;  ///< empty if the variable has no unit
  modeldesc::Type type = modeldesc::Type::real;

  ValueKind kind() const { return kind_of(type); }
};

/// A parameter and its value. The value is a text in the notation of results.csv.
struct ParameterValue {
  std::string name;
  std::string unit;
  std::string value;
  modeldesc::Type type = modeldesc::Type::string;
};

/// The number of cells in a block. A block has 128 KiB and fits into the cache of a core.
inline constexpr std::size_t kBlockCells = 1 << 14;

/// A block of rows, stored as raw numbers, so that the simulation does not wait for formatting. A row consists of its
/// time [s] and one cell for each column. A cell contains the bits of a double, a whole number, or the index of a text
/// in `texts`.
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

  /// Writes the rows of a block. May be called by another thread than the other functions, but never at the same time
  /// as one of them. Throws Error if writing fails, for example because the disk is full.
  virtual void write(const RowBlock& block) = 0;
  /// Writes all rows that were received so far to the file.
  virtual void flush() = 0;

  /// Visits the state that the sink needs to continue from a saved state. A restore resets the sink to this state.
  virtual void visit(state::Visitor& /*v*/) {}
  /// Returns the name under which the sink's state is saved. Returns an empty name if there is no state; such a sink
  /// may be absent in a resumed run.
  virtual std::string_view state_name() const { return {}; }
  /// Must be called after a state was restored. Keeps the first `rows` rows and drops all others. Throws Error if the
  /// sink has fewer rows.
  virtual void keep_rows(std::int64_t /*rows*/) {}
};

}  // namespace mebots::master
