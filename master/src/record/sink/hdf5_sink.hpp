// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "record/sink/row_block.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

namespace mebots::master {

/// Rows as an HDF5 file: `/time`, and one dataset `/<instance>/<variable>` per column, all of one length, chunked and
/// compressed. Reals are 64-bit floats, Integers and enumerations 32-bit, Booleans 8-bit (0 and 1), texts UTF-8 of
/// any length. Attributes: `unit` and `name` (instance.variable, since a `/` in a name is written as `|`).
class Hdf5Sink final : public RowSink {
 public:
  /// Throws InputError when the file cannot be made, Error when its first bytes cannot be written.
  Hdf5Sink(const std::vector<RecordColumn>& columns, const std::filesystem::path& file);
  ~Hdf5Sink() override;
  Hdf5Sink(const Hdf5Sink&) = delete;
  Hdf5Sink& operator=(const Hdf5Sink&) = delete;

  /// Values that hold for the whole run: texts of one row under `/parameters`, as parameters.csv has them.
  void put_parameters(const std::vector<ParameterValue>& parameters);
  void write(const RowBlock& block) override;
  void flush() override;
  /// Takes the name that the file has now.
  void renamed(const std::filesystem::path& file);
  /// Writes the rest and closes the file; nothing may be written afterwards. If any write has failed, removes the file,
  /// which cannot be read, and throws Error.
  void close();
  /// To fewer rows than there are. Throws Error for more.
  void visit(state::Visitor& v) override;

 private:
  struct File;
  std::unique_ptr<File> file_;
};

}  // namespace mebots::master
