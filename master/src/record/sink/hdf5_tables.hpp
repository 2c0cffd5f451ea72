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
  std::string unit;  ///< empty: none
  std::variant<std::vector<std::int64_t>, std::vector<double>, std::vector<std::string>> values;
};

struct Table {
  std::string name;
  std::vector<TableColumn> columns;
};

/// Writes tables as an HDF5 file with a dataset `/<table>/<column>` per column. If the column has a unit, the dataset
/// has the attribute `unit`. A `/` in a name is written as `|`. Equal tables give equal bytes. Throws Error if the file
/// cannot be written.
void write_hdf5(const std::vector<Table>& tables, const std::filesystem::path& file);

}  // namespace mebots::master
