// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "model/value_kind.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// The data that the simulation passes to the writers of result files.
namespace mebots::master {

struct RecordColumn {
  std::string name;  ///< "instance.variable"
  std::string unit;  ///< empty if the variable has no unit
  modeldesc::Type type = modeldesc::Type::real;

  ValueKind kind() const { return kind_of(type); }
};

/// A parameter and its value, in the notation of results.csv.
struct ParameterValue {
  std::string name;
  std::string unit;
  std::string value;
  modeldesc::Type type = modeldesc::Type::string;
};

/// The number of cells in a block. A block of 128 KiB fits into the cache of a core.
inline constexpr std::size_t kBlockCells = 1 << 14;

/// A block of recorded rows. Values are raw bits, because formatting would slow down the simulation. A row consists of
/// its time [s] and one cell per column. A cell contains the bits of a double, an integer, or an index in `texts`.
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

/// Receives the recorded rows of a run in order.
class RowSink {
 public:
  virtual ~RowSink() = default;

  /// Writes the rows of a block. May run on another thread, but never at the same time as another function of the sink.
  /// Throws Error if writing fails, for example because the disk is full.
  virtual void write(const RowBlock& block) = 0;
  /// Writes all received rows to the file.
  virtual void flush() = 0;

  /// Saves or restores the state of the sink.
  virtual void visit(state::Visitor& /*v*/) {}
  /// Returns the name of the sink's state in a checkpoint; an empty name if the sink has no state. A sink without a
  /// state may be missing in the run that resumes from the checkpoint.
  virtual std::string_view state_name() const { return {}; }
  /// Keeps the first `rows` rows and drops all others. Must be called after a restore. Throws Error if the sink has
  /// fewer rows.
  virtual void keep_rows(std::int64_t /*rows*/) {}
};

}  // namespace mebots::master
