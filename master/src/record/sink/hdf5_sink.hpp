// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "record/sink/row_block.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace mebots::master {

/// Writes rows as an HDF5 file. It contains the dataset `/time`, and one dataset `/<instance>/<variable>` for each
/// column. All datasets have the same length, and are chunked and compressed. Reals are stored as 64-bit floats,
/// Integers and enumerations with 32 bits, Booleans with 8 bits (0 and 1), texts as UTF-8 of variable length. A dataset
/// has the attributes `unit` and `name`. `name` is the original instance.variable, because a `/` in a name is written
/// as `|` in the path of the dataset.
class Hdf5Sink final : public RowSink {
 public:
  /// Throws InputError if the file cannot be created, and Error if its first bytes cannot be written.
  Hdf5Sink(const std::vector<RecordColumn>& columns, const std::filesystem::path& file);
  ~Hdf5Sink() override;
  Hdf5Sink(const Hdf5Sink&) = delete;
  Hdf5Sink& operator=(const Hdf5Sink&) = delete;

  /// Writes each parameter and its unit below `/parameters`. Has no effect if the file already contains `/parameters`.
  void put_parameters(const std::vector<ParameterValue>& parameters);
  void write(const RowBlock& block) override;
  void flush() override;
  /// Sets the path after the file was renamed.
  void renamed(const std::filesystem::path& file);
  /// Writes all buffered rows and closes the file. Nothing may be written afterwards. If a write failed, the file is
  /// unreadable; in this case, deletes it and throws Error.
  void close();
  /// Saves or restores the number of rows. A restore deletes the rows that were written after the save. Throws Error if
  /// the file has fewer rows than the saved number.
  void visit(state::Visitor& v) override;
  std::string_view state_name() const override { return "hdf5"; }

 private:
  struct File;
  std::unique_ptr<File> file_;
};

}  // namespace mebots::master
