// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace mebots::master {

struct TableColumn {
  std::string name;
  std::string unit;  ///< empty if the column has no unit
  std::variant<std::vector<std::int64_t>, std::vector<double>, std::vector<std::string>> values;
};

struct Table {
  std::string name;
  std::vector<TableColumn> columns;
};

/// Writes an HDF5 file with a dataset `/<table>/<column>` for each column. The attribute `unit` contains the unit of a
/// column. `|` replaces a `/` in a name. Equal tables give equal bytes. Throws Error if the file cannot be written.
void write_hdf5(const std::vector<Table>& tables, const std::filesystem::path& file);

}  // namespace mebots::master
