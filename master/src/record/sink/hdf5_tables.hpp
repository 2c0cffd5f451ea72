// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace mebots::master {

/// A column of a whole table. All of a table have one length.
struct TableColumn {
  std::string name;
  std::string unit;  ///< empty: none
  std::variant<std::vector<std::int64_t>, std::vector<double>, std::vector<std::string>> values;
};

struct Table {
  std::string name;
  std::vector<TableColumn> columns;
};

/// Writes tables as an HDF5 file: a dataset `/<table>/<column>` each, with the attribute `unit` where there is one; a
/// `/` in a name is written as `|`. The same tables give the same bytes. Throws Error when the file cannot be written.
void write_hdf5(const std::vector<Table>& tables, const std::filesystem::path& file);

}  // namespace mebots::master
