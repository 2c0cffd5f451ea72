// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace mebots::master {

/// A column of a table. All columns of a table have the same length.
struct TableColumn {
  std::string name;
  std::string unit;  ///< empty if the column has no unit
  std::variant<std::vector<std::int64_t>, std::vector<double>, std::vector<std::string>> values;
};

struct Table {
  std::string name;
  std::vector<TableColumn> columns;
};

/// Writes tables as an HDF5 file that has a dataset `/<table>/<column>` for each column. If a column has a unit, its
/// dataset has the attribute `unit`. A `/` in a name is written as `|`. Equal tables result in equal bytes. Throws
/// Error if the file cannot be written.
void write_hdf5(const std::vector<Table>& tables, const std::filesystem::path& file);

}  // namespace mebots::master
