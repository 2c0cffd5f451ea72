// SPDX-License-Identifier: Apache-2.0
#include "record/sink/csv_rows.hpp"

#include "mebots/data/csv.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <bit>
#include <fstream>
#include <string>

namespace mebots::master {
void copy_csv_rows(const std::filesystem::path& file, std::uint64_t bytes, const std::vector<RecordColumn>& columns,
                   RowSink& sink) {
  std::string text(bytes, '\0');
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(text.data(), static_cast<std::streamsize>(bytes))) {
    throw Error(ErrorCode::file_unreadable, fmt::format("{}: this file cannot be read", file.string()));
  }
  const auto fail = [&] {
    throw Error(ErrorCode::state_damaged,
                fmt::format("{}: this file does not hold the rows that were written", file.string()));
  };
  data::CsvReader reader(text, file.string());
  if (reader.header().size() != columns.size() + 1) fail();
  RowBlock block;
  block.cells_per_row = columns.size() + 1;
  while (reader.next()) {
    const auto time_s = data::csv_number<double>(reader.cell(0));
    if (!time_s) fail();
    block.cells.push_back(std::bit_cast<std::uint64_t>(*time_s));
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const auto cell = reader.cell(i + 1);
      if (columns[i].kind == ValueKind::string) {
        block.cells.push_back(block.texts.size());
        block.texts.emplace_back(cell);
      } else if (columns[i].kind == ValueKind::real) {
        const auto value = data::csv_number<double>(cell);
        if (!value) fail();
        block.cells.push_back(std::bit_cast<std::uint64_t>(*value));
      } else {
        const auto value = data::csv_number<std::int64_t>(cell);
        if (!value) fail();
        block.cells.push_back(static_cast<std::uint64_t>(*value));
      }
    }
    if (block.cells.size() < kBlockCells) continue;
    sink.write(block);
    block.clear();
  }
  sink.write(block);
}

}  // namespace mebots::master
