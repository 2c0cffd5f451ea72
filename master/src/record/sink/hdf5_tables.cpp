// SPDX-License-Identifier: Apache-2.0
#include "record/sink/hdf5_tables.hpp"

#include "mebots/error.hpp"
#include "record/sink/hdf5_file.hpp"

#include <fmt/format.h>

namespace mebots::master {
namespace {

using hdf5::Handle;

/// Writes a column to a dataset of the given type. Returns false if HDF5 rejects the data.
bool put_values(hid_t group, const TableColumn& column, hid_t type, const void* values, std::size_t count) {
  const hsize_t length = count;
  const Handle space(H5Screate_simple(1, &length, nullptr), &H5Sclose);
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), &H5Pclose);
  H5Pset_obj_track_times(creation, false);  // equal tables must give equal bytes
  const Handle dataset(
      H5Dcreate2(group, hdf5::without_slashes(column.name).c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT),
      &H5Dclose);
  if (dataset < 0 || H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0) return false;
  return column.unit.empty() || hdf5::put_attribute(dataset, "unit", column.unit);
}

struct Putter {
  hid_t group;
  const TableColumn& column;

  bool operator()(const std::vector<std::int64_t>& values) const {
    return put_values(group, column, H5T_NATIVE_INT64, values.data(), values.size());
  }
  bool operator()(const std::vector<double>& values) const {
    return put_values(group, column, H5T_NATIVE_DOUBLE, values.data(), values.size());
  }
  bool operator()(const std::vector<std::string>& values) const {
    std::vector<const char*> texts;
    texts.reserve(values.size());
    for (const auto& value : values) texts.push_back(value.c_str());
    const Handle type = hdf5::text_type();
    return put_values(group, column, type, texts.data(), texts.size());
  }
};

/// Writes all tables. Returns the names of table and column that HDF5 rejects, or an empty text.
std::string put_tables(hid_t output, const std::vector<Table>& tables) {
  for (const auto& table : tables) {
    const Handle group(
        H5Gcreate2(output, hdf5::without_slashes(table.name).c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
        &H5Gclose);
    for (const auto& column : table.columns) {
      if (!std::visit(Putter{group, column}, column.values))
        return fmt::format("table '{}', column '{}'", table.name, column.name);
    }
  }
  return {};
}

}  // namespace

void write_hdf5(const std::vector<Table>& tables, const std::filesystem::path& file) {
  const std::lock_guard lock(hdf5::library());
  hdf5::File output(file);
  const auto place = put_tables(output.id(), tables);
  output.close();
  if (!place.empty()) {
    throw Error(ErrorCode::file_unwritable, fmt::format("{}: HDF5 could not write {}", file.string(), place));
  }
}

}  // namespace mebots::master
