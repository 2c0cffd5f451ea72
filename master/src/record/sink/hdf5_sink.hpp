// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "record/sink/row_block.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace mebots::master {

/// Writes rows as an HDF5 file with the dataset `/time` and one dataset `/<instance>/<variable>` per column. All
/// datasets have the same length; they are chunked and compressed. Types: Reals are 64-bit floats, Integers and
/// enumerations have 32 bits, Booleans 8 bits, and texts are UTF-8 of variable length. The attributes `name` and `unit`
/// contain instance.variable and its unit. In paths, `|` replaces a `/` of a name.
class Hdf5Sink final : public RowSink {
 public:
  /// Throws InputError if the file cannot be created, and Error if its first bytes cannot be written.
  Hdf5Sink(const std::vector<RecordColumn>& columns, const std::filesystem::path& file);
  ~Hdf5Sink() override;
  Hdf5Sink(const Hdf5Sink&) = delete;
  Hdf5Sink& operator=(const Hdf5Sink&) = delete;

  /// Writes each parameter with its unit below `/parameters`. No effect if the file already contains `/parameters`.
  void put_parameters(const std::vector<ParameterValue>& parameters);
  void write(const RowBlock& block) override;
  void flush() override;
  /// Sets the new path of a renamed file.
  void renamed(const std::filesystem::path& file);
  /// Writes all rows and closes the file. Nothing may be written afterwards. If a write failed, deletes the file, which
  /// is unreadable, and throws Error.
  void close();
  /// Saves or restores the number of rows. A restore deletes later rows. Throws Error if the file has fewer rows.
  void visit(state::Visitor& v) override;
  std::string_view state_name() const override { return "hdf5"; }

 private:
  struct File;
  std::unique_ptr<File> file_;
};

}  // namespace mebots::master
