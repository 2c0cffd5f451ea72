// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "model/value_kind.hpp"

#include <cstdint>
#include <string>
#include <vector>

/// What is recorded, on its way from the simulation to the files.
namespace mebots::master {

/// One recorded variable.
struct RecordColumn {
  std::string name;  ///< "instance.variable"
  std::string unit;  ///< empty without one
  modeldesc::Type type = modeldesc::Type::real;

  ValueKind kind() const { return kind_of(type); }
};

/// A parameter and its value as text, in the forms of results.csv.
struct ParameterValue {
  std::string name;
  std::string unit;
  std::string value;
};

/// Cells after which a block is handed on: 128 KiB, which stay in the cache of a core.
inline constexpr std::size_t kBlockCells = 1 << 14;

/// Rows as raw numbers, so that the simulation need not wait until they are text. A row is its time [s], a double's
/// bits, and one cell per column: a double's bits, a whole number, or the index of a text in `texts`.
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

/// Takes the rows of a run, in their order.
class RowSink {
 public:
  virtual ~RowSink() = default;

  /// May be called by another thread than the other functions, but never at the same time. Throws Error when
  /// the disk is full or broken.
  virtual void write(const RowBlock& block) = 0;
  /// Everything written so far is in the file afterwards.
  virtual void flush() = 0;

  /// Shows what the sink must know to go on from a saved state; when that is put back, the sink goes back to there.
  virtual void visit(state::Visitor& v) = 0;
};

}  // namespace mebots::master
